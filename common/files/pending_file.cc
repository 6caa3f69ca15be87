#include "common/files/pending_file.h"

#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "common/files/open_file.h"

namespace depthfarm {
namespace {

std::string TemporaryName(const std::string& path) {
  static std::atomic<std::uint64_t> counter{0};
  return path + ".tmp-" + std::to_string(getpid()) + "-" + std::to_string(counter.fetch_add(1));
}

}  // namespace

PendingFile::PendingFile(std::string path) : path_(std::move(path)), temporary_(TemporaryName(path_)) {}

PendingFile::~PendingFile() {
  if (!committed_) (void)unlink(temporary_.c_str());
}

Status PendingFile::Commit() {
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) return FileFailure(path_, "rename " + temporary_ + " to it");
  committed_ = true;
  return {};
}

}  // namespace depthfarm
