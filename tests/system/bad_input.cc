#include "tests/system/bad_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

namespace depthfarm::system_test {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

namespace {

constexpr const char* kCameras[] = {"cam0", "cam1", "cam2"};

// Path -> content of every file, "" of folders; symbolic links are not followed.
std::map<std::string, std::string> Everything(const fs::path& folder) {
  std::map<std::string, std::string> found;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().lexically_relative(folder).string();
    found[name] = fs::is_regular_file(entry->symlink_status(error)) ? ReadFile(entry->path()) : "";
  }
  if (fs::is_regular_file(folder, error)) found["."] = ReadFile(folder);
  return found;
}

// Names of files that a writer has begun and not finished.
Words UnfinishedFiles(const fs::path& folder) {
  Words names;
  for (const auto& [name, content] : Everything(folder))
    if (name.find(".tmp") != std::string::npos || name.find(".depthfarm-staging") != std::string::npos)
      names.push_back(name);
  return names;
}

void ExpectWholeFrames(const fs::path& out) {
  EXPECT_THAT(Leftovers(out), IsEmpty());
  EXPECT_FALSE(fs::exists(out / "depth.json")) << "a job that failed has no manifest";
  std::map<std::string, std::set<std::string>> cameras_of_frame;
  for (const char* camera : kCameras) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(out / "depth" / camera, error))
      cameras_of_frame[entry.path().filename().string()].insert(camera);
  }
  for (const auto& [frame, cameras] : cameras_of_frame) EXPECT_EQ(cameras.size(), std::size(kCameras)) << frame;
}

void ReplaceAll(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

void CheckRow(const BadRow& row, const fs::path& scene, const fs::path& depth) {
  SCOPED_TRACE(row.name);
  const BadCase bad(scene, depth);
  if (row.arrange) row.arrange(bad);
  const auto before = Everything(bad.out());
  const Outcome outcome = RunProgram(row.program, bad.Filled(row.command));
  EXPECT_EQ(outcome.exit_code, row.exit_code) << outcome.output;
  for (const std::string& words : bad.Filled(row.says)) EXPECT_THAT(outcome.output, HasSubstr(words));
  EXPECT_THAT(UnfinishedFiles(bad.path()), IsEmpty());
  switch (row.leaves) {
    case Leaves::kNothing:
      EXPECT_FALSE(fs::exists(fs::symlink_status(bad.out()))) << testing::PrintToString(Everything(bad.out()).size());
      break;
    case Leaves::kWhatWasThere:
      EXPECT_EQ(Everything(bad.out()), before);
      break;
    case Leaves::kWholeFrames:
      ExpectWholeFrames(bad.out());
      break;
  }
}

}  // namespace

BadCase::BadCase(const fs::path& scene, const fs::path& depth) {
  fs::copy(scene, this->scene(), fs::copy_options::recursive);
  if (!depth.empty()) fs::copy(depth, this->depth(), fs::copy_options::recursive);
}

void BadCase::EditJson(const fs::path& file, const Edit& edit) {
  nlohmann::json json = nlohmann::json::parse(ReadFile(file));
  edit(json);
  std::ofstream(file, std::ios::trunc) << json.dump();
}

void BadCase::ReplaceInSequence(const std::string& from, const std::string& to) const {
  const fs::path file = scene() / "sequence.json";
  // As it is written by EditJson: one line, keys in alphabetic order.
  std::string text = nlohmann::json::parse(ReadFile(file)).dump();
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  Write(file, text.replace(at, from.size(), to));
}

void BadCase::Write(const fs::path& file, const std::string& bytes) const {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

Words BadCase::Filled(Words words) const {
  for (std::string& word : words) {
    ReplaceAll(word, "{sequence}", (scene() / "sequence.json").string());
    ReplaceAll(word, "{scene}", scene().string());
    ReplaceAll(word, "{depth}", depth().string());
    ReplaceAll(word, "{out}", out().string());
    ReplaceAll(word, "{folder}", path().string());
  }
  return words;
}

Words RunWith(const Words& options) {
  const Words run = {"run", "{sequence}", "-o", "{out}", "--workers", "1"};
  return run + options;
}

void CheckRows(const std::vector<BadRow>& rows, bool with_depth) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 2, .size = "64x48"});
  ASSERT_TRUE(fs::exists(sequence)) << sequence;
  fs::path depth;
  if (with_depth) {
    depth = folder.path() / "depth";
    const Outcome run =
        Depthfarm({"run", sequence, "-o", depth.string(), "--workers", "1", "--levels", "24", "--segments", "100"});
    ASSERT_EQ(run.exit_code, 0) << run.output;
  }
  for (const BadRow& row : rows) CheckRow(row, folder.path() / "scene", depth);
}

}  // namespace depthfarm::system_test
