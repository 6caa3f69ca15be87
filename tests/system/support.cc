#include "tests/system/support.h"

#include <dirent.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is POSIX

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <set>
#include <sstream>
#include <thread>

namespace depthfarm::system_test {

namespace fs = std::filesystem;

bool WaitUntil(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + kDeadline;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = "/tmp/dft-XXXXXX";
  if (::mkdtemp(pattern.data()) != nullptr) path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

fs::path Program(const std::string& name) { return fs::path(DEPTHFARM_PROGRAM_DIR) / name; }

std::string ReadFile(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

Outcome RunProgram(const std::string& name, const Words& arguments) {
  const TemporaryFolder folder;
  const fs::path output = folder / "output";
  Result<ChildProcess> child = ChildProcess::Start(Program(name), arguments, output);
  if (!child.ok()) return {.exit_code = -1, .output = child.status().message()};
  const std::optional<ProcessEnd> end = child->WaitFor(kDeadline);
  Outcome outcome{.exit_code = -1, .output = ReadFile(output)};
  if (end && end->signal == 0) outcome.exit_code = end->exit_code;
  if (!end) outcome.output += "\n(did not end in time)";
  if (end && end->signal != 0) outcome.output += "\n(" + Describe(*end) + ")";
  return outcome;
}

Outcome Depthfarm(const Words& words) {
  const auto says = [&](const char* option) { return std::ranges::find(words, option) != words.end(); };
  const bool may_reuse = !words.empty() && words.front() == "run" && !says("--cache-dir") && !says("--no-cache");
  return RunProgram("depthfarm", may_reuse ? words + Words{"--no-cache"} : words);
}

nlohmann::json ParseJsonTail(const std::string& output) {
  for (std::size_t at = 0; at < output.size();) {
    if (output[at] == '{' || output[at] == '[') {
      nlohmann::json parsed = nlohmann::json::parse(output.substr(at), nullptr, false);
      if (!parsed.is_discarded()) return parsed;
    }
    const std::size_t line_end = output.find('\n', at);
    if (line_end == std::string::npos) break;
    at = line_end + 1;
  }
  return nlohmann::json(nlohmann::json::value_t::discarded);
}

std::string RenderScene(const fs::path& folder, const SceneSize& size) {
  const Outcome rendered =
      RunProgram("depthfarm-media", {"scene", "arc", "-o", folder.string(), "--cameras", std::to_string(size.cameras),
                                     "--frames", std::to_string(size.frames), "--size", size.size});
  return rendered.exit_code == 0 ? (folder / "sequence.json").string() : "scene failed: " + rendered.output;
}

Words SmallJob() { return {"--segments", "600", "--levels", "24", "--gop", "2"}; }

Words operator+(Words first, const Words& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

std::map<std::string, std::string> DepthOf(const fs::path& output_dir) {
  std::map<std::string, std::string> files;
  std::error_code error;
  if (fs::exists(output_dir / "depth.json", error)) files["depth.json"] = ReadFile(output_dir / "depth.json");
  for (const char* folder : {"depth", "confidence"}) {
    for (const auto& entry : fs::recursive_directory_iterator(output_dir / folder, error)) {
      if (entry.is_regular_file()) files[fs::relative(entry.path(), output_dir).string()] = ReadFile(entry.path());
    }
  }
  return files;
}

Words Differences(const std::map<std::string, std::string>& first, const std::map<std::string, std::string>& second) {
  std::set<std::string> names;
  for (const auto& [name, content] : first) {
    const auto other = second.find(name);
    if (other == second.end() || other->second != content) names.insert(name);
  }
  for (const auto& [name, content] : second) {
    if (!first.contains(name)) names.insert(name);
  }
  return {names.begin(), names.end()};
}

Words Leftovers(const fs::path& output_dir) {
  Words names;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(output_dir, error)) {
    const std::string name = fs::relative(entry.path(), output_dir).string();
    const bool whole = entry.path().extension() == ".png" || entry.is_directory();
    const bool ours = name == "depth.json" || name == "views.json" || name == "run.json" || name == ".depthfarm-job" ||
                      name == ".depthfarm-views-job";
    if ((!whole && !ours) || name.starts_with(".depthfarm-staging")) names.push_back(name);
  }
  return names;
}

namespace {

// Fields of /proc/PID/stat after the name in parentheses: state, parent, ...
std::string StatTail(pid_t pid) {
  const std::string stat = ReadFile("/proc/" + std::to_string(pid) + "/stat");
  const std::size_t close = stat.rfind(") ");
  return close == std::string::npos ? "" : stat.substr(close + 2);
}

}  // namespace

std::vector<pid_t> ChildrenOf(pid_t parent, const std::string& program) {
  std::vector<pid_t> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/proc", error)) {
    const std::string name = entry.path().filename().string();
    if (!std::ranges::all_of(name, [](unsigned char c) { return c >= '0' && c <= '9'; })) continue;
    const pid_t pid = static_cast<pid_t>(std::stol(name));
    std::istringstream tail(StatTail(pid));
    char state = 0;
    pid_t its_parent = 0;
    if (!(tail >> state >> its_parent) || its_parent != parent || state == 'Z') continue;
    const fs::path executable = fs::read_symlink(entry.path() / "exe", error);
    if (executable.filename() == program) found.push_back(pid);
  }
  return found;
}

bool IsGone(pid_t pid) {
  const std::string tail = StatTail(pid);
  return tail.empty() || tail[0] == 'Z' || tail[0] == 'X';
}

Farm::Farm(const std::string& endpoint, const std::string& keys)
    : endpoint_(endpoint.empty() ? "ipc://" + (folder_ / "coordinator") : endpoint), keys_(keys) {
  StartCoordinator();
}

bool Farm::RestartCoordinator(int signal) {
  coordinator_->Signal(signal);
  if (!WaitUntil([&] { return coordinator_->Poll().has_value(); })) problem_ = "the coordinator does not end";
  if (ok()) StartCoordinator();
  return ok();
}

void Farm::StartCoordinator() {
  ++coordinators_;
  const Words arguments = Words{"--listen", endpoint_, "--journal", Journal()} + SecurityOptions();
  Result<ChildProcess> coordinator = ChildProcess::Start(Program("depthfarm-coordinator"), arguments, CoordinatorLog());
  if (!coordinator.ok()) {
    problem_ = coordinator.status().message();
    return;
  }
  coordinator_.emplace(std::move(*coordinator));
  // It says where it is bound in fact: the port may have been left open.
  const std::string announcement = "listening on ";
  const bool announced = WaitUntil([&] {
    const std::string log = ReadFile(CoordinatorLog());
    const std::size_t start = log.find(announcement);
    const std::size_t end = start == std::string::npos ? start : log.find('\n', start);
    if (end != std::string::npos)
      endpoint_ = log.substr(start + announcement.size(), end - start - announcement.size());
    return end != std::string::npos || coordinator_->Poll().has_value();
  });
  if (!announced || coordinator_->Poll()) {
    problem_ = "the coordinator does not listen\n" + Logs();
    return;
  }
  Result<std::unique_ptr<Client>> client = Client::Connect(
      {.endpoint = endpoint_, .keys_dir = keys_, .insecure = keys_.empty()},
      {.timeout = std::chrono::milliseconds(kDeadline), .stop = [this] { return coordinator_->Poll().has_value(); }});
  if (!client.ok()) {
    problem_ = client.status().message();
    return;
  }
  client_ = std::move(*client);
  if (const auto jobs = client_->ListJobs(); !jobs.ok()) problem_ = jobs.status().message() + "\n" + Logs();
}

int Farm::AddWorker(const Words& options, const std::string& keys, const Words& under) {
  const std::string name = "worker-" + std::to_string(workers_.size());
  Words words = under + Words{Program("depthfarm-worker").string(), "--coordinator", endpoint_} +
                (keys.empty() ? SecurityOptions() : Words{"--keys", keys}) + options;
  if (std::ranges::find(options, "--cache-dir") == options.end())
    words = words + Words{"--cache-dir", folder_ / (name + "-cache")};
  Result<ChildProcess> worker =
      ChildProcess::Start(words.front(), Words(words.begin() + 1, words.end()), folder_ / (name + ".log"));
  if (!worker.ok()) {
    problem_ = worker.status().message();
    return -1;
  }
  workers_.push_back(std::move(*worker));
  return static_cast<int>(workers_.size()) - 1;
}

Words Farm::Options() const { return Words{"--coordinator", endpoint_} + SecurityOptions(); }

Words Farm::SecurityOptions() const {
  if (!keys_.empty()) return {"--keys", keys_};
  return endpoint_.starts_with("tcp://") ? Words{"--insecure"} : Words{};
}

std::string Farm::LogOf(int index) const { return ReadFile(folder_ / ("worker-" + std::to_string(index) + ".log")); }

std::string Farm::Logs() const {
  std::string text = "coordinator.log:\n" + ReadFile(CoordinatorLog());
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    const std::string log = "worker-" + std::to_string(i) + ".log";
    text += log + ":\n" + ReadFile(folder_ / log);
  }
  return text;
}

}  // namespace depthfarm::system_test
