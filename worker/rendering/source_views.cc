#include "worker/rendering/source_views.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>

#include "common/base/parallel.h"
#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/sequence/output_layout.h"

namespace depthfarm {
namespace {

constexpr std::uint64_t kMaxManifestBytes = std::uint64_t{1} << 30;

}  // namespace

Result<VirtualView> FindSources(const SequenceWithDepth& input, const VirtualPicture& picture) {
  if (picture.frame < input.first_frame || picture.frame >= input.end_frame) {
    return InvalidArgument("frame " + std::to_string(picture.frame) + ": " + input.depth_dir + " has depth of frames " +
                           std::to_string(input.first_frame) + " to " + std::to_string(input.end_frame - 1));
  }
  VirtualView view{picture.camera, picture.frame, {}, picture.number};
  for (const std::string& name : picture.sources) {
    DEPTHFARM_ASSIGN_OR_RETURN(const int source, FindView(input, name));
    if (input.views[static_cast<std::size_t>(source)].depth == nullptr) {
      return InvalidArgument("there is no depth of camera '" + name + "' in " + input.depth_dir);
    }
    view.sources.push_back(source);
  }
  return view;
}

std::vector<std::string> FilesOf(const SequenceWithDepth& input, const VirtualView& view) {
  std::vector<std::string> files;
  for (const int source : view.sources) {
    const SequenceWithDepth::View& of = input.views[static_cast<std::size_t>(source)];
    const auto frame = static_cast<std::size_t>(view.frame);
    if (frame < of.in_sequence->images.size()) files.push_back(of.in_sequence->images[frame]);
    const std::size_t position = frame - static_cast<std::size_t>(input.manifest.first_frame);
    if (of.depth != nullptr && position < of.depth->files.size())
      files.push_back((std::filesystem::path(input.depth_dir) / of.depth->files[position].path).string());
  }
  return files;
}

VirtualPicture ToPicture(const SequenceWithDepth& input, const VirtualView& view) {
  VirtualPicture picture{view.camera, view.frame, {}, view.number};
  for (const int source : view.sources) {
    picture.sources.push_back(input.views[static_cast<std::size_t>(source)].camera.name);
  }
  return picture;
}

Result<RenderSource> RenderSourceOf(const std::string& depth_dir) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(depth_dir, error);
  if (error) return InvalidArgument("depth folder " + depth_dir + ": " + error.message());
  RenderSource source;
  source.depth_dir = absolute.lexically_normal().string();
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes,
                             ReadFileBytes((absolute / kDepthManifestName).string(), kMaxManifestBytes));
  source.manifest_sha256 = Sha256(bytes);
  return source;
}

Status SourceViews::Load(std::span<const VirtualView> views, int threads) {
  std::map<Key, std::shared_ptr<const Source>> needed;
  for (const VirtualView& view : views) {
    for (const int source : view.sources) {
      const auto old = loaded_.find({source, view.frame});
      needed[{source, view.frame}] = old == loaded_.end() ? nullptr : old->second;
    }
  }
  loaded_ = std::move(needed);
  std::vector<Key> missing;
  for (const auto& [key, source] : loaded_)
    if (source == nullptr) missing.push_back(key);
  std::vector<Status> failures(missing.size());
  std::vector<std::shared_ptr<const Source>> read(missing.size());
  ParallelFor(missing.size(), threads, [&](std::size_t i) { failures[i] = Read(missing[i], read[i]); });
  for (std::size_t i = 0; i < missing.size(); ++i) {
    DEPTHFARM_RETURN_IF_ERROR(failures[i]);
    loaded_[missing[i]] = read[i];
  }
  return {};
}

Result<SynthesizedView> SourceViews::Render(const VirtualView& view) const {
  std::vector<SourceView> sources;
  for (const int source : view.sources) {
    const Source& loaded = *loaded_.at({source, view.frame});
    sources.push_back({&loaded.picture, &loaded.depth, input_.views[static_cast<std::size_t>(source)].camera});
  }
  return SynthesizeView(sources, view.camera);
}

Status SourceViews::Read(const Key& key, std::shared_ptr<const Source>& result) const {
  auto source = std::make_shared<Source>();
  DEPTHFARM_ASSIGN_OR_RETURN(source->picture, ReadPictureOf(input_, key.first, key.second));
  DEPTHFARM_ASSIGN_OR_RETURN(source->depth, ReadDepthOf(input_, key.first, key.second));
  result = std::move(source);
  return {};
}

}  // namespace depthfarm
