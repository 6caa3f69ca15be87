#include "tests/simulation/task_model.h"

#include <string_view>

#include "common/digest/sha256.h"
#include "common/job/job_manifest.h"

namespace depthfarm::simulation {
namespace {

std::string Bytes(const std::array<std::uint8_t, 32>& digest) { return {digest.begin(), digest.end()}; }

std::string Hex(const std::string& bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

// Roles, views and contents of what the task reads.
std::string Read(const TaskSpec& spec) {
  std::string read = spec.picture;
  for (const TaskInput& input : spec.inputs) {
    read += '/' + std::to_string(static_cast<int>(input.role)) + ',' + std::to_string(input.view) + ',';
    read += Bytes(input.artifact.content_digest);
  }
  return read;
}

}  // namespace

ArtifactKey AnalysisKeyOf(const TaskSpec& spec) {
  std::string named = "analysis of " + spec.picture;
  for (const TaskInput& input : spec.inputs) named += '/' + Bytes(input.artifact.key);
  return Sha256(named);
}

ContentDigest PictureDigestOf(const TaskSpec& spec) { return Sha256("picture " + spec.picture); }

ArtifactInfo ArtifactOf(const TaskSpec& spec, const ArtifactKey& key) {
  const ContentDigest content = Sha256(TaskKindName(spec.id.kind) + ' ' + Bytes(key) + ' ' + Read(spec));
  return {key, 1000U + 40U * content[0], content};
}

std::vector<MadeFile> FilesOf(const TaskSpec& spec, const JobConfig& config) {
  std::vector<MadeFile> files;
  for (const VirtualPicture& view : spec.views) {
    std::string path = ViewFileName(view.number);
    const std::string content = Hex(Bytes(Sha256(path + ' ' + Bytes(config.render->manifest_sha256))));
    files.push_back({std::move(path), content});
  }
  if (config.render) return files;
  for (std::string& path : FilesOfFrame(config.resolved, spec.id.frame)) {
    const std::string content = Hex(Bytes(Sha256(path + ' ' + Read(spec))));
    files.push_back({std::move(path), content});
  }
  return files;
}

std::vector<OutputFile> Describe(const std::vector<MadeFile>& files) {
  std::vector<OutputFile> described;
  for (const MadeFile& file : files) described.push_back({file.path, Sha256(file.bytes), file.bytes.size()});
  return described;
}

}  // namespace depthfarm::simulation
