#include "common/files/file_bundle.h"

#include <algorithm>
#include <cstdint>
#include <set>

#include "common/base/little_endian.h"

namespace depthfarm {
namespace {

constexpr std::string_view kMagic = "DFFB";
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kEntryBytes = 12;  // before the path
constexpr std::size_t kMaxFiles = 2048;
constexpr std::size_t kMaxPathBytes = 1000;

Status Bad(const std::string& what) { return Corrupt("bundle of files: " + what); }

bool IsPlainName(std::string_view name) {
  return !name.empty() && name != "." && name != ".." &&
         std::ranges::none_of(name, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

bool StaysInFolder(std::string_view path) {
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    if (!IsPlainName(path.substr(begin, end - begin))) return false;
    begin = end + 1;
  }
  return true;
}

}  // namespace

std::string EncodeFileBundle(const std::vector<BundledFile>& files) {
  std::size_t size = kHeaderBytes;
  for (const BundledFile& file : files) size += kEntryBytes + file.path.size() + file.bytes.size();
  std::string bundle;
  bundle.reserve(size);
  bundle += kMagic;
  AppendU32(kVersion, bundle);
  AppendU32(static_cast<std::uint32_t>(files.size()), bundle);
  for (const BundledFile& file : files) {
    AppendU32(static_cast<std::uint32_t>(file.path.size()), bundle);
    AppendU64(file.bytes.size(), bundle);
    bundle += file.path;
  }
  for (const BundledFile& file : files) bundle += file.bytes;
  return bundle;
}

Result<std::vector<BundledFile>> DecodeFileBundle(std::string_view bundle) {
  if (bundle.size() < kHeaderBytes || !bundle.starts_with(kMagic)) return Bad("does not begin with DFFB");
  if (ReadU32(bundle, 4) != kVersion) return Bad("version is " + std::to_string(ReadU32(bundle, 4)) + ", expected 1");
  const std::size_t count = ReadU32(bundle, 8);
  if (count > kMaxFiles)
    return Bad("has " + std::to_string(count) + " files, expected at most " + std::to_string(kMaxFiles));
  std::vector<BundledFile> files;
  std::vector<std::uint64_t> sizes;
  std::set<std::string_view> paths;
  std::size_t at = kHeaderBytes;
  for (std::size_t i = 0; i < count; ++i) {
    if (bundle.size() - at < kEntryBytes) return Bad("ends in the list of its files");
    const std::size_t length = ReadU32(bundle, at);
    sizes.push_back(ReadU64(bundle, at + 4));
    at += kEntryBytes;
    if (length == 0 || length > kMaxPathBytes || length > bundle.size() - at)
      return Bad("path " + std::to_string(i) + " has " + std::to_string(length) + " bytes, expected 1 to 1000");
    const std::string_view path = bundle.substr(at, length);
    if (!StaysInFolder(path)) return Bad("path " + std::to_string(i) + " is not made of plain names");
    if (!paths.insert(path).second) return Bad("'" + std::string(path) + "' is there twice");
    files.push_back({path, {}});
    at += length;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (sizes[i] > bundle.size() - at) return Bad("ends in '" + std::string(files[i].path) + "'");
    files[i].bytes = bundle.substr(at, static_cast<std::size_t>(sizes[i]));
    at += files[i].bytes.size();
  }
  if (at != bundle.size()) return Bad(std::to_string(bundle.size() - at) + " bytes follow its last file");
  return files;
}

}  // namespace depthfarm
