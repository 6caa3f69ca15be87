#include "coordinator/cli/cluster_report.h"

#include <algorithm>

#include "coordinator/engines/command.h"

namespace depthfarm {
namespace {

std::string Plural(std::uint64_t number, const std::string& thing) {
  return std::to_string(number) + " " + thing + (number == 1 ? "" : "s");
}

std::size_t Busy(const std::vector<v1::WorkerStatus>& workers) {
  return static_cast<std::size_t>(
      std::ranges::count_if(workers, [](const v1::WorkerStatus& worker) { return worker.tasks() > 0; }));
}

std::string Bounds(const WorkerRange& range) {
  return range.min == range.max ? std::to_string(range.min)
                                : std::to_string(range.min) + ".." + std::to_string(range.max);
}

}  // namespace

std::string HowToSubmit(const ClusterRecord& record) {
  std::string text = "export DEPTHFARM_COORDINATOR=" + ShellQuoted(record.coordinator);
  if (!record.keys_dir.empty()) text += " DEPTHFARM_KEYS=" + ShellQuoted(record.keys_dir);
  return text + "\ndepthfarm submit SEQUENCE -o DIR" + (record.options.insecure ? " --insecure" : "") + "\n";
}

std::string FormatCluster(const ClusterReport& report) {
  const ClusterRecord& record = report.record;
  std::string text = "cluster " + record.options.name + " (" + std::string(EngineName(record.options.engine)) + "), " +
                     (report.managed ? "up since " + record.started + ", managed by process " +
                                           std::to_string(record.manager_pid) + " on " + record.manager_host
                                     : "without a manager: depthfarm cluster down tidies up") +
                     "\n  coordinator: " + record.coordinator + (report.backlog ? "" : ", does not answer") + "\n";
  text += "  workers: " + Bounds(record.options.workers) + " of " +
          Plural(static_cast<std::uint64_t>(record.options.slots), "slot") + "; " +
          std::to_string(report.workers.size()) + " joined, " + std::to_string(Busy(report.workers)) + " busy";
  if (report.pilots) {
    const auto running = std::ranges::count_if(*report.pilots, &Pilot::running);
    text += "; " + std::to_string(running) + " started, " +
            std::to_string(report.pilots->size() - static_cast<std::size_t>(running)) + " waiting";
  }
  text += "\n";
  if (report.backlog) {
    text += "  work: " + Plural(report.backlog->leased(), "task") + " under way, " +
            std::to_string(report.backlog->ready()) + " ready, " + Plural(report.backlog->unopened_gops(), "group") +
            " of pictures to come\n";
  }
  if (report.pilots) {
    for (const Pilot& pilot : *report.pilots) {
      text += "    " + pilot.id + (pilot.host.empty() ? "" : " on " + pilot.host) + ": " + pilot.state + "\n";
    }
  }
  return text;
}

nlohmann::ordered_json ClusterToJson(const ClusterReport& report) {
  const ClusterRecord& record = report.record;
  nlohmann::ordered_json json;
  json["name"] = record.options.name;
  json["engine"] = EngineName(record.options.engine);
  json["managed"] = report.managed;
  json["manager"] = {{"host", record.manager_host}, {"process", record.manager_pid}};
  json["started"] = record.started;
  json["coordinator"] = record.coordinator;
  json["keys"] = record.keys_dir;
  json["answers"] = report.backlog.has_value();
  json["minWorkers"] = record.options.workers.min;
  json["maxWorkers"] = record.options.workers.max;
  json["slots"] = record.options.slots;
  json["joined"] = report.workers.size();
  json["busy"] = Busy(report.workers);
  if (report.backlog) {
    json["tasksUnderWay"] = report.backlog->leased();
    json["tasksReady"] = report.backlog->ready();
    json["gopsToCome"] = report.backlog->unopened_gops();
  }
  if (report.pilots) {
    json["pilots"] = nlohmann::ordered_json::array();
    for (const Pilot& pilot : *report.pilots) {
      json["pilots"].push_back(
          {{"id", pilot.id}, {"running", pilot.running}, {"host", pilot.host}, {"state", pilot.state}});
    }
  }
  return json;
}

}  // namespace depthfarm
