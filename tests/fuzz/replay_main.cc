// Plays a stored corpus: every input that ever broke a decoder, and good ones. Where no fuzzer is, these are the tests.
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_target.h"

namespace {

// No decoder may take more than this for an input of a corpus (docs/reliability.md, Fuzzing). Address spaces of
// sanitizers are larger from the start.
void BoundMemory() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  constexpr rlim_t kMostBytes = rlim_t{1} << 30;
  const rlimit limit = {kMostBytes, kMostBytes};
  setrlimit(RLIMIT_AS, &limit);
#endif
}

std::string BytesOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER-OF-INPUTS\n", argv[0]);
    return 2;
  }
  BoundMemory();
  std::vector<std::filesystem::path> inputs;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1], error)) inputs.push_back(entry.path());
  std::sort(inputs.begin(), inputs.end());
  for (const std::filesystem::path& input : inputs) {
    std::printf("%s\n", input.filename().c_str());
    std::fflush(stdout);  // the last name is that of the input that ended the program
    const std::string bytes = BytesOf(input);
    // A copy of the exact size, so that a read beyond it is found.
    const std::vector<std::uint8_t> exact(bytes.begin(), bytes.end());
    LLVMFuzzerTestOneInput(exact.data(), exact.size());
  }
  std::printf("%zu inputs, %ju accepted\n", inputs.size(), static_cast<std::uintmax_t>(depthfarm::fuzz::accepted));
  if (depthfarm::fuzz::accepted > 0) return 0;
  std::fprintf(stderr, "%s: no input is a good one, so little was tested: make the corpus anew with fuzz-seeds\n",
               argv[1]);
  return 1;
}
