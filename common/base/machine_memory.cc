#include "common/base/machine_memory.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

std::optional<std::uint64_t> ReadNumber(const fs::path& path) {
  std::ifstream file(path);
  std::string text;
  if (!(file >> text)) return std::nullopt;
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;  // "max": no bound
  return number;
}

// The path of the process's group of version 2, "0::/path"; empty when there is none.
std::string GroupOf(const std::string& proc_cgroup) {
  std::ifstream file(proc_cgroup);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("0::/")) return line.substr(4);
  }
  return {};
}

}  // namespace

std::uint64_t MachineMemory(const std::string& cgroup_root, const std::string& proc_cgroup) {
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long page_bytes = sysconf(_SC_PAGESIZE);
  std::uint64_t bytes = 0;
  if (pages > 0 && page_bytes > 0) bytes = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page_bytes);
  // Every group above the process's own may bound it.
  const fs::path root(cgroup_root);
  fs::path group = GroupOf(proc_cgroup);
  while (true) {
    if (const std::optional<std::uint64_t> bound = ReadNumber(root / group / "memory.max"))
      bytes = bytes == 0 ? *bound : std::min(bytes, *bound);
    if (group.empty()) return bytes;
    group = group.parent_path();
  }
}

std::uint64_t TaskMemory(std::uint64_t machine_bytes, std::uint64_t cache_bytes, int workers) {
  const std::uint64_t share = machine_bytes / static_cast<std::uint64_t>(workers);
  return share - std::min(cache_bytes, share / 2);
}

}  // namespace depthfarm
