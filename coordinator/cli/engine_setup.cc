#include "coordinator/cli/engine_setup.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <thread>

#include "common/wire/bounds.h"
#include "coordinator/clusters/cluster_folder.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr WorkerRange kUsualWorkers{0, 8};

WorkerRange UsualWorkers(EngineKind engine) {
  if (engine != EngineKind::kLocal) return kUsualWorkers;
  return {0, std::max(1, static_cast<int>(std::thread::hardware_concurrency()))};
}

void MakeAbsolute(std::string& path) {
  if (!path.empty()) path = fs::absolute(path).lexically_normal().string();
}

}  // namespace

Result<ClusterOptions> ResolveClusterOptions(const EngineArguments& arguments) {
  ClusterOptions options = arguments.options;
  DEPTHFARM_ASSIGN_OR_RETURN(options.engine, ParseEngine(arguments.engine));
  options.workers = UsualWorkers(options.engine);
  if (!arguments.workers.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(options.workers, ParseWorkerRange(arguments.workers));
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckClusterOptions(options));
  DEPTHFARM_RETURN_IF_ERROR(CheckTags("--tags", options.tags).status());
  options.state_dir = arguments.state_dir;
  if (options.state_dir.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(options.state_dir, ClusterFolder::DefaultPath(options.name));
  }
  // --cache-dir and --worker-program are of the workers' machines: as they are.
  MakeAbsolute(options.state_dir);
  MakeAbsolute(options.keys_dir);
  MakeAbsolute(options.hosts_file);
  return options;
}

Status CheckNoEngineOptions(const EngineArguments& arguments) {
  ClusterOptions options = arguments.options;
  options.cache_dir.clear();
  options.cache_size.clear();
  options.slots = ClusterOptions().slots;
  if (options == ClusterOptions() && arguments.state_dir.empty()) return {};
  return InvalidArgument(
      "options of an engine or of its workers, such as --slurm-partition, --hosts or --path-map, need --engine slurm "
      "or "
      "--engine ssh");
}

}  // namespace depthfarm
