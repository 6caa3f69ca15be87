#include <filesystem>

#include "common/files/file_bundle.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  const std::string_view bundle = fuzz::Text(data, size);
  const auto files = DecodeFileBundle(bundle);
  if (!files.ok()) return 0;
  ++fuzz::accepted;
  for (const BundledFile& file : *files) {
    const std::filesystem::path below = (std::filesystem::path("/folder") / file.path).lexically_normal();
    fuzz::Require(below.string().starts_with("/folder/"), "a file stays in the folder that it is put into");
  }
  fuzz::Require(EncodeFileBundle(*files) == bundle, "a bundle has one spelling");
  return 0;
}
