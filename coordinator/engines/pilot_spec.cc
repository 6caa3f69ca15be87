#include "coordinator/engines/pilot_spec.h"

#include <algorithm>

#include "common/base/machine_memory.h"

namespace depthfarm {
namespace {

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

}  // namespace

std::vector<std::string> WorkerArguments(const PilotSpec& spec) {
  std::vector<std::string> words = {"--coordinator",     spec.coordinator,
                                    "--slots",           std::to_string(spec.slots),
                                    "--threads",         std::to_string(spec.threads),
                                    "--give-up-seconds", std::to_string(spec.give_up_seconds)};
  const auto add = [&words](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
  if (spec.stop_grace_seconds > 0) add({"--stop-grace", std::to_string(spec.stop_grace_seconds)});
  if (!spec.keys_dir.empty()) add({"--keys", spec.keys_dir});
  if (spec.insecure) add({"--insecure"});
  if (!spec.cache_dir.empty()) add({"--cache-dir", spec.cache_dir});
  if (!spec.cache_size.empty()) add({"--cache-size", spec.cache_size});
  if (spec.memory_bytes > 0) {
    // Decoded artifacts get a quarter: they save reading, tasks that do not fit are not done at all.
    const std::uint64_t cache = std::min(kUsualCacheBytes, spec.memory_bytes / 4);
    add({"--memory", std::to_string(cache), "--task-memory", std::to_string(TaskMemory(spec.memory_bytes, cache))});
  }
  if (!spec.tags.empty()) add({"--tags", Joined(spec.tags)});
  for (const std::string& mapping : spec.path_map) add({"--path-map", mapping});
  return words;
}

std::string WorkerName(std::string_view cluster, std::string_view pilot, std::string_view restart) {
  return std::string(cluster) + "." + std::string(pilot) + "." + std::string(restart);
}

std::optional<std::string> PilotOfWorker(std::string_view cluster, std::string_view worker) {
  if (!worker.starts_with(cluster) || worker.substr(cluster.size(), 1) != ".") return std::nullopt;
  worker.remove_prefix(cluster.size() + 1);
  const std::size_t dot = worker.rfind('.');
  if (dot == std::string_view::npos || dot == 0) return std::nullopt;
  return std::string(worker.substr(0, dot));
}

}  // namespace depthfarm
