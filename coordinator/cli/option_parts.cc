#include "coordinator/cli/option_parts.h"

#include <CLI/CLI.hpp>  // 10 s to compile

#include "coordinator/clusters/cluster_options.h"

namespace depthfarm {
namespace {

// CLI11 takes -1 for a size of 20 digits.
CLI::Validator SizeWithoutMinus() {
  return {[](const std::string& text) {
            return text.find('-') == std::string::npos ? "" : "is '" + text + "', expected a size such as 8GB";
          },
          ""};
}

}  // namespace

void AddJsonFlag(CLI::App& app, bool& json) { app.add_flag("--json", json, "Print JSON for programs"); }

CLI::Option* AddThreads(CLI::App& app, int& threads) {
  return app
      .add_option("--threads", threads,
                  "Threads of each worker, that its slots share, at least one each: a task takes those that would be "
                  "idle, so that a frame ends sooner; its depth is the same")
      ->type_name("T")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
}

void AddWorkerRange(CLI::App& app, std::string& workers, const std::string& help) {
  const auto check = [](const std::string& text) {
    const Result<WorkerRange> range = ParseWorkerRange(text);
    return range.ok() ? "" : range.status().message();
  };
  app.add_option("--workers", workers, help)->type_name("N|A..B")->check(check)->group(kWorkersGroup);
}

void AddEngine(CLI::App& app, EngineArguments& arguments, const char* partition) {
  const char* group = "Engine";
  ClusterOptions& options = arguments.options;
  app.add_option("--engine", arguments.engine,
                 "Who provides the workers: this machine, Slurm, or hosts that are reached by ssh")
      ->type_name("local|slurm|ssh")
      ->capture_default_str()
      ->group(group);
  app.add_option(partition, options.partition, "Slurm: partition of the workers; default: Slurm's")
      ->type_name("P")
      ->group(group);
  app.add_option("--time", options.time,
                 "Slurm: time limit of a worker, as sbatch takes it, e.g. 4:00:00; a worker hands its tasks back two "
                 "minutes before, and another one is asked for")
      ->type_name("T")
      ->group(group);
  app.add_option("--account", options.account, "Slurm: account that is charged")->type_name("A")->group(group);
  app.add_option("--qos", options.qos, "Slurm: quality of service")->type_name("Q")->group(group);
  app.add_option("--engine-option", options.engine_arguments,
                 "One more option of sbatch or ssh, e.g. --engine-option=--constraint=avx2; may be repeated")
      ->type_name("OPTION")
      ->allow_extra_args(false)
      ->group(group);
  app.add_option("--hosts", options.hosts_file, "ssh: file of lines 'HOST [WORKERS]'")->type_name("FILE")->group(group);
  app.add_option("--state", arguments.state_dir,
                 "Folder for keys, logs and the coordinator's journal, which the workers' machines see under the same "
                 "name; default: depthfarm/clusters/NAME in $XDG_STATE_HOME or ~/.local/state")
      ->type_name("DIR")
      ->group(group);
  app.add_option("--host", options.host, "Name or address that workers reach this machine by; default: its own name")
      ->type_name("HOST")
      ->group(group);
  app.add_option("--port", options.port, "Of the coordinator; default: a free one")
      ->type_name("PORT")
      ->check(CLI::Range(1, 65535))
      ->group(group);
  app.add_option("--slots", options.slots, "Tasks that each worker computes at a time")
      ->type_name("N")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str()
      ->group(kWorkersGroup);
  app.add_option("--worker-memory", options.worker_memory_bytes,
                 "Memory of each worker, e.g. 8GB, asked for and kept to; default: what its machine has, shared out on "
                 "this one. "
                 "Name it where a host of ssh runs several")
      ->transform(CLI::AsSizeValue(false).description(""))
      ->transform(SizeWithoutMinus())
      ->type_name("SIZE")
      ->group(kWorkersGroup);
  app.add_option("--worker-program", options.worker_program,
                 "Where the workers' machines have depthfarm-worker; default: where this one has it")
      ->type_name("FILE")
      ->group(kWorkersGroup);
  app.add_option("--cache-dir", options.cache_dir,
                 "Folder of the artifacts on each machine, shared by its workers and kept; default: temporary ones")
      ->type_name("DIR")
      ->group(kWorkersGroup);
  app.add_option("--cache-size", options.cache_size, "Bound of that folder; default: 8GB")
      ->transform(CLI::AsSizeValue(false).description(""))
      ->transform(SizeWithoutMinus())
      ->type_name("SIZE")
      ->group(kWorkersGroup);
  app.add_option("--path-map", options.path_map,
                 "What jobs name below FROM is below TO on the workers' machines; may be repeated")
      ->type_name("FROM=TO")
      ->allow_extra_args(false)
      ->group(kWorkersGroup);
}

}  // namespace depthfarm
