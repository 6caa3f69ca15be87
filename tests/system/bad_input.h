#ifndef DEPTHFARM_TESTS_SYSTEM_BAD_INPUT_H_
#define DEPTHFARM_TESTS_SYSTEM_BAD_INPUT_H_

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/system/support.h"

namespace depthfarm::system_test {

// A folder in which one bad input is arranged: a scene of three cameras and two frames, and, where it was asked for,
// its depth.
class BadCase {
 public:
  BadCase(const std::filesystem::path& scene, const std::filesystem::path& depth);

  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
  [[nodiscard]] std::filesystem::path scene() const { return path() / "scene"; }
  [[nodiscard]] std::filesystem::path depth() const { return path() / "depth"; }
  [[nodiscard]] std::filesystem::path out() const { return path() / "out"; }

  using Edit = std::function<void(nlohmann::json&)>;
  void EditSequence(const Edit& edit) const { EditJson(scene() / "sequence.json", edit); }
  void EditManifest(const Edit& edit) const { EditJson(depth() / "depth.json", edit); }
  // The text of the sequence file after `from` was replaced by `to`, once.
  void ReplaceInSequence(const std::string& from, const std::string& to) const;
  // Makes folders above it.
  void Write(const std::filesystem::path& file, const std::string& bytes) const;

  // `words` with {sequence}, {scene}, {depth}, {out} and {folder} filled in.
  [[nodiscard]] Words Filled(Words words) const;

 private:
  static void EditJson(const std::filesystem::path& file, const Edit& edit);

  TemporaryFolder folder_;
};

// What a command may leave in the output folder.
enum class Leaves {
  kNothing,       // it is not there
  kWhatWasThere,  // everything as before
  kWholeFrames,   // what a job leaves that failed on the way: frames of all cameras, its marker, run.json
};

struct BadRow {
  std::string name;
  std::function<void(const BadCase&)> arrange = {};
  Words command = {};
  Words says = {};  // all of it is in what the command prints
  int exit_code = 2;
  Leaves leaves = Leaves::kNothing;
  std::string program = "depthfarm";
};

// `depthfarm run` of the scene with these options besides.
[[nodiscard]] Words RunWith(const Words& options = {});

// Arranges and runs each row and compares with what it says. The scene, and with `with_depth` its depth, are made once.
void CheckRows(const std::vector<BadRow>& rows, bool with_depth = false);

}  // namespace depthfarm::system_test

#endif  // DEPTHFARM_TESTS_SYSTEM_BAD_INPUT_H_
