#include "coordinator/cli/cluster_line.h"

#include <CLI/CLI.hpp>  // 10 s to compile

#include "coordinator/cli/option_parts.h"

namespace depthfarm {
namespace {

void AddState(CLI::App& app, EngineArguments& arguments) {
  app.add_option("--name", arguments.options.name, "Name of the cluster")->type_name("NAME")->capture_default_str();
  app.add_option("--state", arguments.state_dir,
                 "Its folder; default: depthfarm/clusters/NAME in $XDG_STATE_HOME or ~/.local/state")
      ->type_name("DIR");
}

void DefineClusterUp(CLI::App& app, ClusterArguments& arguments) {
  EngineArguments& engine = arguments.engine;
  AddWorkerRange(app, engine.workers,
                 "How many, or bounds: as many as there is work for; default: 0..CORES on this machine, 0..8 else");
  AddEngine(app, engine, "--partition");
  AddThreads(app, engine.options.threads)->group(kWorkersGroup);
  app.add_option("--tags", engine.options.tags, "What the workers have, for jobs submitted with --require")
      ->type_name("TAG,...")
      ->delimiter(',')
      ->group(kWorkersGroup);
  app.add_option("--idle-seconds", engine.options.idle_seconds,
                 "A worker that is not needed leaves after so long without a task")
      ->type_name("S")
      ->check(CLI::Range(1, 86400))
      ->capture_default_str()
      ->group(kWorkersGroup);
  app.add_option("--name", engine.options.name, "Name of the cluster, to have several")
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--coordinator", engine.options.coordinator,
                 "A coordinator that exists, to provide it with workers; default: one is started")
      ->type_name("tcp://HOST:PORT");
  app.add_option("--keys", engine.options.keys_dir,
                 "Folder with the keys for that coordinator, a client's of role admin and a worker's")
      ->type_name("DIR");
  app.add_flag("--insecure", engine.options.insecure, "That coordinator has no keys: loopback addresses only");
  CLI::Option* batch = app.add_flag("--batch", engine.options.manager_as_job,
                                    "Slurm: coordinator and manager run as a batch job, not on this machine");
  app.add_flag("--foreground", arguments.foreground, "Stay, tell what happens, and end the cluster with Ctrl-C")
      ->excludes(batch);
  app.footer(
      "Starts a coordinator and, while there is work for them, workers: they are asked for as jobs are submitted and\n"
      "leave when they are idle. What it prints is how to submit to it. The journal of the coordinator stays in the "
      "state\n"
      "folder: a cluster that goes down with jobs in it goes on with them when it is up again.\n"
      "Examples:\n"
      "  depthfarm cluster up --engine slurm --workers 4..64 --partition render --time 8:00:00 --worker-memory 8GB\n"
      "  depthfarm cluster up --engine ssh --hosts hosts.txt --workers 0..12 --cache-dir /var/tmp/depthfarm\n"
      "  depthfarm cluster up --workers 2");
}

}  // namespace

void DefineCluster(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<ClusterArguments>();
  app.require_subcommand(1);
  using Action = ClusterArguments::Action;
  const auto add = [&](const char* name, const char* summary, Action action) {
    CLI::App* command = app.add_subcommand(name, summary);
    command->callback([&arguments, action] { arguments.action = action; });
    return command;
  };
  DefineClusterUp(*add("up", "Start a farm whose workers come and go with the work", Action::kUp), arguments);
  CLI::App* status = add("status", "Workers, waiting ones, and the work there is", Action::kStatus);
  AddState(*status, arguments.engine);
  AddJsonFlag(*status, arguments.json);
  CLI::App* down = add("down", "End workers and coordinator; unfinished jobs stay in its journal", Action::kDown);
  AddState(*down, arguments.engine);
  // What `up` starts in the background, or as a batch job.
  CLI::App* manage = add("manage", "Manage a cluster", Action::kManage);
  AddState(*manage, arguments.engine);
  manage->group("");
  app.footer("Help of each: depthfarm cluster up --help");
}

}  // namespace depthfarm
