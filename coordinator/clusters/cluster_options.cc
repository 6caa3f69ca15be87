#include "coordinator/clusters/cluster_options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

namespace depthfarm {
namespace {

constexpr int kMostWorkers = 1024;
constexpr std::size_t kMostNameBytes = 32;

constexpr auto kEngines = std::to_array<std::pair<EngineKind, std::string_view>>(
    {{EngineKind::kLocal, "local"}, {EngineKind::kSlurm, "slurm"}, {EngineKind::kSsh, "ssh"}});

std::optional<int> ParseInt(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// A line of a batch script or an argument: what would end it, or begin another, is refused.
Status CheckWord(std::string_view option, const std::string& text) {
  const bool ok = std::ranges::all_of(text, [](unsigned char c) { return c >= 0x20 && c != 0x7f; });
  return ok ? Status() : InvalidArgument(std::string(option) + " holds a control character");
}

// One list of the fields for both directions.
template <typename Options, typename Visitor>
void VisitFields(Options& options, Visitor&& visit) {
  visit("name", options.name);
  visit("stateDir", options.state_dir);
  visit("minWorkers", options.workers.min);
  visit("maxWorkers", options.workers.max);
  visit("slots", options.slots);
  visit("threads", options.threads);
  visit("workerMemoryBytes", options.worker_memory_bytes);
  visit("workerProgram", options.worker_program);
  visit("cacheDir", options.cache_dir);
  visit("cacheSize", options.cache_size);
  visit("tags", options.tags);
  visit("pathMap", options.path_map);
  visit("idleSeconds", options.idle_seconds);
  visit("coordinator", options.coordinator);
  visit("keysDir", options.keys_dir);
  visit("insecure", options.insecure);
  visit("host", options.host);
  visit("port", options.port);
  visit("keepsJournal", options.keeps_journal);
  visit("managerAsJob", options.manager_as_job);
  visit("partition", options.partition);
  visit("time", options.time);
  visit("account", options.account);
  visit("qos", options.qos);
  visit("engineArguments", options.engine_arguments);
  visit("hostsFile", options.hosts_file);
}

}  // namespace

std::string_view EngineName(EngineKind kind) {
  return std::ranges::find(kEngines, kind, &std::pair<EngineKind, std::string_view>::first)->second;
}

Result<EngineKind> ParseEngine(std::string_view name) {
  const auto engine = std::ranges::find(kEngines, name, &std::pair<EngineKind, std::string_view>::second);
  if (engine != kEngines.end()) return engine->first;
  return InvalidArgument("engine is '" + std::string(name) + "', expected local, slurm or ssh");
}

Result<WorkerRange> ParseWorkerRange(std::string_view text) {
  const std::size_t dots = text.find("..");
  const std::optional<int> first = ParseInt(text.substr(0, dots));
  const std::optional<int> last = dots == std::string_view::npos ? first : ParseInt(text.substr(dots + 2));
  const int least = dots == std::string_view::npos ? 1 : 0;
  if (!first || !last || *first < least || *last < 1 || *last < *first || *last > kMostWorkers) {
    return InvalidArgument("workers are '" + std::string(text) + "', expected 1 to " + std::to_string(kMostWorkers) +
                           ", or bounds such as 4..64");
  }
  return WorkerRange{*first, *last};
}

Status CheckClusterOptions(const ClusterOptions& options) {
  const bool legal_name =
      !options.name.empty() && options.name.size() <= kMostNameBytes &&
      std::ranges::all_of(options.name, [](unsigned char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
      });
  if (!legal_name) {
    return InvalidArgument("--name is '" + options.name + "', expected 1 to " + std::to_string(kMostNameBytes) +
                           " letters, digits, '-' and '_'");
  }
  const bool slurm = options.engine == EngineKind::kSlurm;
  const bool ssh = options.engine == EngineKind::kSsh;
  for (const auto& [option, value] :
       std::to_array<std::pair<std::string_view, const std::string*>>({{"--partition", &options.partition},
                                                                       {"--time", &options.time},
                                                                       {"--account", &options.account},
                                                                       {"--qos", &options.qos}})) {
    DEPTHFARM_RETURN_IF_ERROR(CheckWord(option, *value));
    if (!value->empty() && !slurm) return InvalidArgument(std::string(option) + " is for --engine slurm");
  }
  for (const std::string& argument : options.engine_arguments) {
    DEPTHFARM_RETURN_IF_ERROR(CheckWord("--engine-option", argument));
    if (!slurm && !ssh) return InvalidArgument("--engine-option is for --engine slurm and ssh");
    if (!argument.starts_with("-")) {
      return InvalidArgument("--engine-option is '" + argument + "', expected an option of " +
                             (slurm ? "sbatch, such as --constraint=avx2" : "ssh, such as -p2222"));
    }
  }
  if (options.manager_as_job && !slurm) return InvalidArgument("--batch is for --engine slurm");
  if (ssh && options.hosts_file.empty()) return InvalidArgument("--engine ssh needs --hosts FILE");
  if (!ssh && !options.hosts_file.empty()) return InvalidArgument("--hosts is for --engine ssh");
  if (!options.coordinator.empty() && (options.port != 0 || !options.host.empty())) {
    return InvalidArgument("--host and --port are for a coordinator that is started, not for --coordinator");
  }
  if (options.coordinator.empty() && (!options.keys_dir.empty() || options.insecure)) {
    return InvalidArgument(
        "--keys and --insecure belong to --coordinator: keys of a coordinator that is started are made");
  }
  return {};
}

std::string ClusterOptionsToJson(const ClusterOptions& options) {
  nlohmann::ordered_json json;
  json["engine"] = EngineName(options.engine);
  VisitFields(options, [&json](const char* name, const auto& value) { json[name] = value; });
  return json.dump(2) + "\n";
}

Result<ClusterOptions> ClusterOptionsFromJson(std::string_view text) {
  ClusterOptions options;
  try {
    const nlohmann::json json = nlohmann::json::parse(text);
    DEPTHFARM_ASSIGN_OR_RETURN(options.engine, ParseEngine(json.at("engine").get<std::string>()));
    VisitFields(options, [&json](const char* name, auto& value) { json.at(name).get_to(value); });
  } catch (const nlohmann::json::exception& error) {
    return Corrupt(std::string("no options of a cluster: ") + error.what());
  }
  return options;
}

}  // namespace depthfarm
