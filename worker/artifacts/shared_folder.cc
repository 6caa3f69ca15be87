#include "worker/artifacts/shared_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "common/base/little_endian.h"
#include "common/digest/sha256.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kKeyBytes = std::tuple_size_v<ArtifactKey>;
constexpr std::size_t kNameLength = 2 * kKeyBytes;
constexpr std::string_view kHexDigits = "0123456789abcdef";
constexpr std::string_view kMagic = "DFSUM001";  // then the sum and the time of the last release, 8 bytes each
constexpr std::size_t kSumBytes = kMagic.size() + 16;
constexpr std::int64_t kNanosPerSecond = 1'000'000'000;
constexpr int kFileMode = 0600;
// Bits that mean nothing to a file of data. They change at once with its rank, and there is no time between.
constexpr mode_t kReleasedMark = S_IXUSR;
constexpr mode_t kKeptMark = S_ISVTX;
constexpr mode_t kAllPermissions = 07777;

SharedFolder::Rank RankOf(mode_t mode) {
  if ((mode & kKeptMark) != 0) return SharedFolder::Rank::kKept;
  return (mode & kReleasedMark) != 0 ? SharedFolder::Rank::kReleased : SharedFolder::Rank::kUsed;
}

mode_t MarkOf(SharedFolder::Rank rank) {
  if (rank == SharedFolder::Rank::kUsed) return 0;
  return rank == SharedFolder::Rank::kKept ? kKeptMark : kReleasedMark;
}

std::optional<ArtifactKey> KeyOf(std::string_view name) {
  if (name.size() != kNameLength) return std::nullopt;
  ArtifactKey key{};
  for (std::size_t i = 0; i < name.size(); ++i) {
    const std::size_t digit = kHexDigits.find(name[i]);
    if (digit == std::string_view::npos) return std::nullopt;
    key[i / 2] = static_cast<std::uint8_t>((key[i / 2] << 4) | digit);
  }
  return key;
}

// A file that was being written when its process was killed: a key and more.
bool IsLeftover(std::string_view name) {
  return name.size() > kNameLength && name[kNameLength] == '.' && KeyOf(name.substr(0, kNameLength)).has_value();
}

int OpenOrMake(const fs::path& path) {
  return open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kFileMode);
}

// 0 or the reason, as errno.
int Lock(const OpenFile& file, int how) {
  while (flock(file.descriptor(), how) != 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

// Nothing when it cannot be read.
std::string FirstBytes(const OpenFile& file, std::size_t count) {
  std::string bytes(count, '\0');
  const Result<std::size_t> have = ReadUpTo("", file, 0, bytes);
  bytes.resize(have.ok() ? *have : 0);
  return bytes;
}

// A few bytes, or keys of one task: the disk takes them at once or not at all.
bool WriteAt(const OpenFile& file, std::string_view bytes) {
  return pwrite(file.descriptor(), bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size());
}

// False if there is no such file or the mark cannot be set.
bool SetRankOf(const fs::path& path, SharedFolder::Rank rank) {
  struct stat facts {};
  if (lstat(path.c_str(), &facts) != 0 || !S_ISREG(facts.st_mode) || RankOf(facts.st_mode) == rank) return false;
  const mode_t others = facts.st_mode & kAllPermissions & ~(kReleasedMark | kKeptMark);
  return chmod(path.c_str(), others | MarkOf(rank)) == 0;
}

std::int64_t Nanoseconds(const timespec& time) { return time.tv_sec * kNanosPerSecond + time.tv_nsec; }

Status MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Unavailable(folder.string() + ": cannot make the folder: " + error.message());
  return {};
}

// Where earlier versions of the program had an artifact.
fs::path EarlierPath(const fs::path& folder, const std::string& name) {
  return folder / name.substr(0, 2) / name.substr(2, 2) / name;
}

// Earlier versions of the program held the lock as long as they ran.
constexpr std::chrono::seconds kLongestOpen{20};

}  // namespace

Result<std::unique_ptr<SharedFolder>> SharedFolder::Open(fs::path folder) {
  DEPTHFARM_RETURN_IF_ERROR(MakeFolder(folder / "pins"));
  DEPTHFARM_RETURN_IF_ERROR(MakeFolder(folder / "turns"));
  const std::string path = (folder / "lock").string();
  const int file = OpenOrMake(path);
  if (file < 0) return FileFailure(path, "open the file");
  std::unique_ptr<SharedFolder> shared(new SharedFolder(std::move(folder), file));
  const auto deadline = std::chrono::steady_clock::now() + kLongestOpen;
  while (Lock(shared->lock_, LOCK_EX | LOCK_NB) != 0) {
    if (std::chrono::steady_clock::now() > deadline)
      return Unavailable(shared->folder_.string() + ": its lock is held by a program that does not share it");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  Change change(shared.get());
  DEPTHFARM_RETURN_IF_ERROR(shared->OpenPins());
  shared->last_release_ = shared->NextTime();  // others count anew
  DEPTHFARM_RETURN_IF_ERROR(shared->Count());
  return shared;
}

SharedFolder::~SharedFolder() {
  std::error_code ignored;  // whoever looks at it next finds that nobody holds it
  if (pins_file_ != nullptr) fs::remove(pins_path_, ignored);
}

Status SharedFolder::OpenPins() {
  static std::atomic<std::uint64_t> last = 0;
  const std::set<ArtifactKey> others = PinsOfOthers();
  for (int attempt = 0; attempt < 1000; ++attempt) {
    pins_path_ = folder_ / "pins" / (std::to_string(getpid()) + "-" + std::to_string(++last));
    // Of containers two processes may have one number.
    auto file = std::make_unique<OpenFile>(
        open(pins_path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, kFileMode));
    if (!file->ok() && errno == EEXIST) continue;
    if (!file->ok()) return FileFailure(pins_path_.string(), "make the file");
    if (Lock(*file, LOCK_EX | LOCK_NB) != 0) return FileFailure(pins_path_.string(), "lock the file");
    pins_file_ = std::move(file);
    return {};
  }
  return Unavailable(folder_.string() + ": too many files in 'pins'");
}

fs::path SharedFolder::PathOf(const ArtifactKey& key) const {
  const std::string name = Hex(key);
  return folder_ / name.substr(0, 1) / name;
}

std::string SharedFolder::TemporaryFor(const ArtifactKey& key) {
  // The name of the pins is nobody else's, not even in another container.
  return PathOf(key).string() + ".tmp-" + pins_path_.filename().string() + "-" + std::to_string(++last_temporary_);
}

std::optional<SharedFolder::StoredFile> SharedFolder::Stat(const ArtifactKey& key) const {
  struct stat facts {};
  if (lstat(PathOf(key).c_str(), &facts) != 0 || !S_ISREG(facts.st_mode)) return std::nullopt;
  return StoredFile{RankOf(facts.st_mode), Nanoseconds(facts.st_mtim), key, static_cast<std::uint64_t>(facts.st_size)};
}

Result<std::vector<SharedFolder::StoredFile>> SharedFolder::List() const {
  std::vector<StoredFile> files;
  std::error_code error;
  fs::recursive_directory_iterator entries(folder_, error);
  for (; !error && entries != fs::recursive_directory_iterator(); entries.increment(error)) {
    const std::optional<ArtifactKey> key = KeyOf(entries->path().filename().string());
    if (!key.has_value() || entries->path() != PathOf(*key)) continue;
    if (const auto file = Stat(*key)) files.push_back(*file);
  }
  if (error) return Unavailable(folder_.string() + ": cannot list the folder: " + error.message());
  std::ranges::sort(files);
  return files;
}

Status SharedFolder::Count() {
  counted_ = false;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<StoredFile> files, List());
  counted_ = true;
  bytes_ = 0;
  for (const StoredFile& file : files) bytes_ += file.bytes;
  victims_ = {files.begin(), files.end()};
  last_release_counted_ = last_release_;
  return {};
}

Status SharedFolder::ReadSum() {
  const std::string sum = FirstBytes(lock_, kSumBytes);
  if (sum.size() != kSumBytes || !sum.starts_with(kMagic)) {
    last_release_ = NextTime();  // perhaps there was one
    return Count();
  }
  bytes_ = ReadU64(sum, kMagic.size());
  last_release_ = static_cast<std::int64_t>(ReadU64(sum, kMagic.size() + 8));
  counted_ = true;
  // Until the change is over the sum is not valid: should this process be killed, the next one counts.
  if (!WriteAt(lock_, std::string(kMagic.size(), '-')))
    return FileFailure((folder_ / "lock").string(), "write the file");
  return {};
}

Result<SharedFolder::Change> SharedFolder::Begin() {
  if (const int reason = Lock(lock_, LOCK_EX); reason != 0)
    return Unavailable((folder_ / "lock").string() + ": cannot lock: " + std::generic_category().message(reason));
  if (const Status read = ReadSum(); !read.ok()) {
    (void)Lock(lock_, LOCK_UN);
    return read;
  }
  return Change(this);
}

SharedFolder::Change::~Change() {
  if (folder_ == nullptr) return;
  std::string sum(kMagic);
  AppendU64(folder_->bytes_, sum);
  AppendU64(static_cast<std::uint64_t>(folder_->last_release_), sum);
  // A disk that does not take it leaves a sum that is not valid.
  if (folder_->counted_) (void)WriteAt(folder_->lock_, sum);
  (void)Lock(folder_->lock_, LOCK_UN);
}

Status SharedFolder::Change::Add(const ArtifactKey& key, const std::string& written_as) {
  const std::optional<StoredFile> before = folder_->Stat(key);
  const fs::path path = folder_->PathOf(key);
  std::error_code error;
  fs::rename(written_as, path, error);
  if (error) return Unavailable(path.string() + ": cannot rename the new file: " + error.message());
  if (before) folder_->bytes_ -= std::min(folder_->bytes_, before->bytes);
  folder_->Touch(key);
  if (const std::optional<StoredFile> added = folder_->Stat(key)) folder_->bytes_ += added->bytes;
  return {};
}

void SharedFolder::Change::Remove(const ArtifactKey& key) {
  const std::optional<StoredFile> file = folder_->Stat(key);
  std::error_code error;
  if (file && fs::remove(folder_->PathOf(key), error)) folder_->bytes_ -= std::min(folder_->bytes_, file->bytes);
}

void SharedFolder::Change::SetRank(const ArtifactKey& key, Rank rank) {
  if (!SetRankOf(folder_->PathOf(key), rank)) return;
  folder_->Touch(key);
  if (rank == Rank::kKept) return;  // who takes it for a victim sees that it has changed
  // It goes earlier than others know.
  const bool others_released_none = folder_->last_release_counted_ == folder_->last_release_;
  folder_->last_release_ = std::max(folder_->NextTime(), folder_->last_release_ + 1);
  if (others_released_none) folder_->last_release_counted_ = folder_->last_release_;
  if (const std::optional<StoredFile> file = folder_->Stat(key)) folder_->victims_.insert(*file);
}

bool SharedFolder::RemoveUnlessChanged(const StoredFile& victim) {
  const std::optional<StoredFile> now = Stat(victim.key);
  if (now != victim) {
    // It was used, which puts it behind other released ones only.
    if (now && now->rank == Rank::kReleased) victims_.insert(*now);
    return false;
  }
  std::error_code error;
  if (!fs::remove(PathOf(victim.key), error)) return false;
  bytes_ -= std::min(bytes_, now->bytes);
  return true;
}

Status SharedFolder::Change::MakeRoom(std::uint64_t needed, std::uint64_t max_bytes,
                                      std::vector<ArtifactKey>& removed) {
  const auto fits = [&] { return needed <= max_bytes && bytes() <= max_bytes - needed; };
  if (fits()) return {};
  const std::set<ArtifactKey> others = folder_->PinsOfOthers();
  std::set<StoredFile>& victims = folder_->victims_;
  const auto remove_until = [&](Rank last) {
    for (auto next = victims.begin(); next != victims.end() && next->rank <= last && !fits();) {
      const StoredFile victim = *next++;
      if (folder_->pins_.contains(victim.key) || others.contains(victim.key)) continue;
      victims.erase(victim);
      if (folder_->RemoveUnlessChanged(victim)) removed.push_back(victim.key);
      next = victims.upper_bound(victim);
    }
  };
  // Kept ones go when a new count has shown that there is nothing else.
  if (folder_->last_release_counted_ == folder_->last_release_) remove_until(Rank::kUsed);
  if (fits()) return {};
  DEPTHFARM_RETURN_IF_ERROR(folder_->Count());
  remove_until(Rank::kKept);
  if (fits()) return {};
  return Unavailable("artifact of " + std::to_string(needed) + " bytes: all " + std::to_string(bytes()) +
                     " bytes in the store of " + std::to_string(max_bytes) +
                     " belong to running tasks: raise --cache-size");
}

std::set<ArtifactKey> SharedFolder::PinsOfOthers() {
  std::set<ArtifactKey> keys;
  bool alone = true;
  std::error_code error;
  for (fs::directory_iterator entry(folder_ / "pins", error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    const fs::path& path = entry->path();
    if (pins_file_ != nullptr && path == pins_path_) continue;
    const OpenFile file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
    if (!file.ok()) continue;
    if (Lock(file, LOCK_SH | LOCK_NB) == 0) {  // its owner has ended
      std::error_code ignored;
      fs::remove(path, ignored);
      continue;
    }
    alone = false;
    struct stat facts {};
    if (fstat(file.descriptor(), &facts) != 0) continue;
    const std::string pinned = FirstBytes(file, static_cast<std::size_t>(facts.st_size));
    for (std::size_t at = 0; at + kKeyBytes <= pinned.size(); at += kKeyBytes) {
      ArtifactKey key{};
      std::copy_n(pinned.begin() + static_cast<std::ptrdiff_t>(at), kKeyBytes, key.begin());
      keys.insert(key);
    }
  }
  if (alone && pins_file_ == nullptr) TidyUp();
  return keys;
}

void SharedFolder::TidyUp() const {
  std::error_code error;
  std::vector<fs::path> leftovers;
  std::vector<fs::path> to_move;
  for (fs::recursive_directory_iterator entry(folder_, error); !error && entry != fs::recursive_directory_iterator();
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (IsLeftover(name)) leftovers.push_back(entry->path());
    const std::optional<ArtifactKey> key = KeyOf(name);
    if (!key.has_value()) continue;
    if (entry->path() == PathOf(*key)) (void)SetRankOf(entry->path(), Rank::kUsed);
    if (entry->path() == EarlierPath(folder_, name)) to_move.push_back(entry->path());
  }
  // What stays is found again at the next start.
  for (const fs::path& path : leftovers) fs::remove(path, error);
  for (const fs::path& path : to_move) {
    const fs::path moved = PathOf(*KeyOf(path.filename().string()));
    fs::create_directory(moved.parent_path(), error);
    fs::rename(path, moved, error);
    if (error) continue;
    (void)SetRankOf(moved, Rank::kUsed);
    fs::remove(path.parent_path(), error);  // the last one takes its folders with it
    fs::remove(path.parent_path().parent_path(), error);
  }
}

void SharedFolder::SetPins(const std::set<ArtifactKey>& keys) {
  pins_ = keys;
  std::string bytes;
  for (const ArtifactKey& key : keys) bytes.append(reinterpret_cast<const char*>(key.data()), key.size());
  // Not while another one reads them to see what may go. One that goes in spite of a full disk is fetched again.
  if (Lock(lock_, LOCK_EX) != 0) return;
  if (WriteAt(*pins_file_, bytes)) (void)!ftruncate(pins_file_->descriptor(), static_cast<off_t>(bytes.size()));
  (void)Lock(lock_, LOCK_UN);
}

std::int64_t SharedFolder::NextTime() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  // The clock may stand still between two calls, and what is used later must be newer.
  last_time_ = std::max(Nanoseconds(now), last_time_ + 1);
  return last_time_;
}

void SharedFolder::Touch(const ArtifactKey& key) {
  const std::int64_t time = NextTime();
  const timespec used{.tv_sec = time / kNanosPerSecond, .tv_nsec = time % kNanosPerSecond};
  const std::array<timespec, 2> times{used, used};
  (void)utimensat(AT_FDCWD, PathOf(key).c_str(), times.data(), AT_SYMLINK_NOFOLLOW);
}

FetchTurn::FetchTurn(const fs::path& folder, const ArtifactKey& key, const std::stop_token& stop)
    : file_(OpenOrMake(folder / "turns" / Hex(key).substr(0, 3))) {
  using std::chrono::milliseconds;
  milliseconds pause(1);
  while (file_.ok() && !stop.stop_requested() && Lock(file_, LOCK_EX | LOCK_NB) == EWOULDBLOCK) {
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, milliseconds(20));
  }
}

}  // namespace depthfarm
