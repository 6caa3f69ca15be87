#include "common/sequence/depth_manifest.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  const auto manifest = ParseDepthManifest(fuzz::Text(data, size), "depth.json");
  if (!manifest.ok()) return 0;
  ++fuzz::accepted;
  const auto text = FormatDepthManifest(*manifest);
  fuzz::Require(text.ok(), "a manifest that was read can be written");
  const auto again = ParseDepthManifest(*text, "depth.json");
  fuzz::Require(again.ok(), "a manifest that was written can be read");
  fuzz::Require(FormatDepthManifest(*again).value() == *text, "what is read is what was written");
  return 0;
}
