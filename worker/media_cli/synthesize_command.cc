#include "worker/media_cli/synthesize_command.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <system_error>
#include <thread>

#include "common/base/parallel.h"
#include "worker/media_cli/picture_sink.h"
#include "worker/media_cli/virtual_views.h"
#include "worker/rendering/source_views.h"

namespace depthfarm {
namespace {

// A line that is overwritten by the next state and erased at the end, whatever the end: an error begins its own line.
class ProgressLine {
 public:
  // Without `out` nothing is shown.
  explicit ProgressLine(std::ostream* out) : out_(out) {}
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { Show(""); }

  void Show(const std::string& text) {
    if (out_ == nullptr) return;
    *out_ << "\r" << text << std::string(shown_ > text.size() ? shown_ - text.size() : 0, ' ');
    if (text.empty()) *out_ << "\r";
    *out_ << std::flush;
    shown_ = text.size();
  }

 private:
  std::ostream* out_;
  std::size_t shown_ = 0;
};

// PNG files in a folder; 0 if it is none.
std::size_t PicturesIn(const std::string& folder) {
  std::error_code error;
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    count += entry.path().extension() == ".png" ? 1 : 0;
  }
  return count;
}

Result<std::string> Rendered(const VirtualView& view, const SourceViews& sources, const PictureSink& sink) {
  DEPTHFARM_ASSIGN_OR_RETURN(const SynthesizedView result, sources.Render(view));
  return sink.Encode(result.picture);
}

}  // namespace

Status RunSynthesize(const SynthesizeCommandOptions& options, std::ostream& out) {
  if (options.threads < 0) {
    return InvalidArgument("--threads is " + std::to_string(options.threads) +
                           ", expected at least 1, or 0: one per core");
  }
  if (options.frames_per_second < 1 || options.frames_per_second > 1000) {
    return InvalidArgument("--fps is " + std::to_string(options.frames_per_second) + ", expected 1 to 1000");
  }
  const int threads =
      options.threads > 0 ? options.threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  SequenceWithDepth input;
  DEPTHFARM_RETURN_IF_ERROR(ReadSequenceWithDepth(options.sequence, options.depth_dir, input));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<VirtualView> views, PlanVirtualViews(options, input));
  const Camera& first = views.front().camera;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::unique_ptr<PictureSink> sink,
                             OpenPictureSink(options.output, {first.width, first.height, options.frames_per_second}));

  SourceViews sources(input);
  ProgressLine progress(options.progress);
  const std::span<const VirtualView> all(views);
  for (std::size_t begin = 0; begin < all.size(); begin += static_cast<std::size_t>(threads)) {
    if (options.interrupted()) return Cancelled();
    progress.Show("picture " + std::to_string(begin + 1) + " of " + std::to_string(all.size()));
    const auto batch = all.subspan(begin, std::min(static_cast<std::size_t>(threads), all.size() - begin));
    DEPTHFARM_RETURN_IF_ERROR(sources.Load(batch, threads));
    std::vector<Result<std::string>> pictures(batch.size(), Cancelled());
    ParallelFor(batch.size(), threads, [&](std::size_t i) { pictures[i] = Rendered(batch[i], sources, *sink); });
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (!pictures[i].ok()) return pictures[i].status().WithContext("frame " + std::to_string(batch[i].frame));
      DEPTHFARM_RETURN_IF_ERROR(sink->Write(batch[i].number, *pictures[i]));
    }
  }
  DEPTHFARM_RETURN_IF_ERROR(sink->Finish());
  progress.Show("");
  out << views.size() << (views.size() == 1 ? " picture of " : " pictures of ") << first.width << "x" << first.height
      << " from";
  const auto name = [&](const std::vector<int>& of) {
    for (const int source : of) out << " " << input.views[static_cast<std::size_t>(source)].camera.name;
  };
  name(views.front().sources);
  if (views.back().sources != views.front().sources) {
    out << " to";
    name(views.back().sources);
  }
  out << " -> " << options.output << "\n";
  const std::size_t pictures = PicturesIn(options.output);
  if (pictures > views.size()) {
    out << "note: " << options.output << " also holds " << pictures - views.size() << " older pictures\n";
  }
  return {};
}

}  // namespace depthfarm
