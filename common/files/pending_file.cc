#include "common/files/pending_file.h"

#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <random>
#include <utility>

#include "common/files/open_file.h"

namespace depthfarm {
namespace {

// Containers number their processes alike, and share folders.
std::uint64_t NumberOfProcess() {
  std::random_device random;
  return std::uint64_t{random()} << 32U | random();
}

}  // namespace

std::string UniqueSuffix() {
  static const std::uint64_t process = NumberOfProcess();
  static std::atomic<std::uint64_t> counter{0};
  return std::to_string(getpid()) + "-" + std::to_string(process) + "-" + std::to_string(counter.fetch_add(1));
}

PendingFile::PendingFile(std::string path) : path_(std::move(path)), temporary_(path_ + ".tmp-" + UniqueSuffix()) {}

PendingFile::~PendingFile() {
  if (!committed_) (void)unlink(temporary_.c_str());
}

Status PendingFile::Commit() {
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) return FileFailure(path_, "rename " + temporary_ + " to it");
  committed_ = true;
  return {};
}

}  // namespace depthfarm
