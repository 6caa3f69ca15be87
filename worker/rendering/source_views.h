#ifndef DEPTHFARM_WORKER_RENDERING_SOURCE_VIEWS_H_
#define DEPTHFARM_WORKER_RENDERING_SOURCE_VIEWS_H_

#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/status.h"
#include "common/job/virtual_picture.h"
#include "common/synthesis/synthesize_view.h"
#include "worker/rendering/sequence_with_depth.h"

namespace depthfarm {

// One picture to be made, its sources found.
struct VirtualView {
  Camera camera;
  int frame = 0;             // of the sequence
  std::vector<int> sources;  // indices into SequenceWithDepth::views, at least one
  int number = 0;            // names its file
};

// The picture as seen from `input`. kInvalidArgument: a source that is not there or has no depth, a frame without
// depth.
[[nodiscard]] Result<VirtualView> FindSources(const SequenceWithDepth& input, const VirtualPicture& picture);
// Pictures and depth files that the view is made from; those that are not there are left out.
[[nodiscard]] std::vector<std::string> FilesOf(const SequenceWithDepth& input, const VirtualView& view);
// The other way round, for a job.
[[nodiscard]] VirtualPicture ToPicture(const SequenceWithDepth& input, const VirtualView& view);

// Where a rendering job finds its depth: the folder's absolute path and the digest of its depth.json.
[[nodiscard]] Result<RenderSource> RenderSourceOf(const std::string& depth_dir);

// The pictures and depth that some virtual views are made from. Must not outlive `input`.
class SourceViews {
 public:
  explicit SourceViews(const SequenceWithDepth& input) : input_(input) {}

  // Reads what `views` need, on up to `threads` threads, and forgets what they do not.
  [[nodiscard]] Status Load(std::span<const VirtualView> views, int threads);
  // The picture of a view that was among the last ones loaded. Safe from several threads.
  [[nodiscard]] Result<SynthesizedView> Render(const VirtualView& view) const;

 private:
  struct Source {
    YcbcrImage picture;
    DepthMap depth;
  };
  using Key = std::pair<int, int>;  // view, frame

  [[nodiscard]] Status Read(const Key& key, std::shared_ptr<const Source>& result) const;

  const SequenceWithDepth& input_;
  std::map<Key, std::shared_ptr<const Source>> loaded_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_RENDERING_SOURCE_VIEWS_H_
