#ifndef DEPTHFARM_COORDINATOR_CLI_ARGUMENTS_H_
#define DEPTHFARM_COORDINATOR_CLI_ARGUMENTS_H_

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "coordinator/cli/estimation_options.h"
#include "coordinator/cli/farm_options.h"
#include "coordinator/clusters/cluster_options.h"
#include "coordinator/importing/import_options.h"

namespace depthfarm {

// What a job is made of, as the command line names it.
struct JobArguments {
  std::string sequence;
  std::string output_dir;
  bool allow_outside = false;
  EstimationArguments estimation;
};

// A farm whose workers an engine provides.
struct EngineArguments {
  ClusterOptions options;
  std::string engine = "local";
  std::string workers;  // a number or a range; empty: not said
  std::string state_dir;
};

struct LocalFarmArguments {
  int workers = 0;             // 0: see ShapeOfFarm
  int slots = 0;               // of each worker; 0: same
  int threads = 1;             // that they share
  std::string worker_log_dir;  // empty: the private temporary folder
  std::string log_level = "info";
  std::string cache_dir;   // shared by the workers and kept; empty: the private temporary folder
  std::string cache_size;  // its bound, bytes; empty: the worker's own
};

struct DemoArguments {
  std::string output_dir = "depthfarm-demo";
};
struct RunArguments {
  JobArguments job;
  LocalFarmArguments farm;
  EngineArguments engine;
  bool no_cache = false;
  bool json = false;
};
struct PlanArguments {
  JobArguments job;  // without an output folder
  int workers = 0;   // 0: several, until more do not help
  bool json = false;
};
struct BenchArguments {
  std::string sequence;  // empty: an arc scene is rendered, as the next three say
  std::string size = "1024x768";
  int cameras = 5;
  std::uint64_t seed = 1;
  bool allow_outside = false;
  EstimationArguments estimation;  // its preset is a list with commas
  int workers = 1;
  int threads = 1;
  int repeats = 1;
  bool json = false;
};
struct SubmitArguments {
  JobArguments job;
  FarmArguments farm;
  int priority = 0;
  std::string name;  // empty: the sequence's
  std::vector<std::string> required_tags;
  bool upload = false;
  std::string upload_listen;  // endpoint; empty: chosen
  std::string upload_host;    // host name or address for workers; empty: this host's name
  bool wait = false;
  bool json = false;
};
struct StatusArguments {
  FarmArguments farm;
  std::uint64_t job = 0;
  bool json = false;
};
struct WatchArguments {
  FarmArguments farm;
  std::uint64_t job = 0;
  bool json = false;
};
struct LogsArguments {
  FarmArguments farm;
  std::uint64_t job = 0;
  std::string task;  // empty: all
  bool json = false;
};
struct JobsArguments {
  FarmArguments farm;
  bool json = false;
};
struct CancelArguments {
  FarmArguments farm;
  std::uint64_t job = 0;
};
struct RetryArguments {
  FarmArguments farm;
  std::uint64_t job = 0;
  bool wait = false;
  bool json = false;
};
struct WorkersArguments {
  FarmArguments farm;
  bool json = false;
};
struct DrainArguments {
  FarmArguments farm;
  std::string worker;
};
struct FetchArguments {
  FarmArguments farm;
  std::uint64_t job = 0;
  std::string output_dir;
  bool wait = false;
  bool json = false;
};
struct VerifyArguments {
  std::string directory;
  bool json = false;
};
struct ImportArguments {
  ImportOptions options;
  bool json = false;
};
struct KeygenArguments {
  std::string output_dir;
};

struct ClusterArguments {
  enum class Action { kUp, kStatus, kDown, kManage };
  Action action = Action::kUp;
  EngineArguments engine;
  bool foreground = false;
  bool json = false;
};

using CommandArguments =
    std::variant<DemoArguments, RunArguments, PlanArguments, BenchArguments, SubmitArguments, StatusArguments,
                 WatchArguments, LogsArguments, JobsArguments, CancelArguments, RetryArguments, WorkersArguments,
                 DrainArguments, FetchArguments, VerifyArguments, ImportArguments, KeygenArguments, ClusterArguments>;

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_ARGUMENTS_H_
