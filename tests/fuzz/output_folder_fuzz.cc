#include "common/sequence/guides.h"
#include "common/sequence/output_check.h"
#include "common/sequence/sequence.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/temporary_folder.h"

// Files that describe a folder: the first byte says which one is there.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  static const testing_support::TemporaryFolder folder;
  std::string_view rest = fuzz::Text(data, size);
  const bool prior = fuzz::TakeByte(rest) % 2 == 1;
  const std::string file = folder.Write(prior ? "prior.json" : "views.json", rest);
  if (prior) {
    folder.Write("depth/cam0/0000.pfm", "Pf");
    Sequence sequence;
    sequence.cameras.resize(1);
    sequence.cameras[0].camera.name = "cam0";
    sequence.cameras[0].images = {"/0.png", "/1.png"};
    if (AddPriors(folder.path().string(), sequence).ok()) {
      ++fuzz::accepted;
      const PriorFormat& format = sequence.cameras[0].prior_format;
      fuzz::Require(format.holds != PriorFormat::Holds::kNothing && format.unit > 0, "a prior holds something");
    }
  } else {
    const auto check = CheckOutput(folder.path().string(), [] { return false; });
    if (check.ok()) {
      ++fuzz::accepted;
      fuzz::Require(check->files >= check->missing.size() + check->changed.size(), "files are counted");
    }
  }
  std::filesystem::remove(file);
  return 0;
}
