#include "tests/simulation/simulated_disk.h"

#include <sqlite3.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <optional>
#include <utility>

namespace depthfarm::simulation {
namespace {

constexpr int kSectorBytes = 512;  // a torn write ends at the end of one

struct Change {
  std::optional<std::uint64_t> truncated;  // to that size; else bytes at an offset
  std::uint64_t offset = 0;
  std::string bytes;
};

struct File {
  std::string content;           // as its process sees it
  std::string synced;            // as it surely is after a power cut
  std::vector<Change> unsynced;  // from `synced` to `content`
};

void Apply(const Change& change, std::string& content) {
  if (change.truncated) {
    content.resize(*change.truncated);
    return;
  }
  const std::size_t end = change.offset + change.bytes.size();
  if (content.size() < end) content.resize(end);
  std::copy(change.bytes.begin(), change.bytes.end(), content.begin() + static_cast<std::ptrdiff_t>(change.offset));
}

// The first part of a write.
Change TornPart(const Change& change, test::Random& random) {
  Change torn = change;
  const int sectors = static_cast<int>(change.bytes.size()) / kSectorBytes;
  torn.bytes.resize(static_cast<std::size_t>(random.Int(0, sectors)) * kSectorBytes);
  return torn;
}

}  // namespace

struct SimulatedDisk::State {
  explicit State(std::uint64_t seed) : random(seed) {}

  // Counts a change; false when the disk is dead, or dies by this one: then a part of it may still happen.
  bool Live(const std::string& file, const Change& change) {
    if (dead) return false;
    ++writes;
    if (writes != dies_at) return true;
    dead = true;
    if (random.Chance(50)) Write(file, change.truncated ? change : TornPart(change, random));
    return false;
  }
  void Write(const std::string& path, const Change& change) {
    File& file = files[path];
    Apply(change, file.content);
    file.unsynced.push_back(change);
  }

  test::Random random;
  std::string name;
  sqlite3_vfs vfs{};
  std::map<std::string, File> files;
  bool dead = false;
  int writes = 0;
  int dies_at = 0;
};

namespace {

struct OpenFile {
  sqlite3_file base;
  SimulatedDisk::State* disk;
  std::string* name;
};

OpenFile& Of(sqlite3_file* file) { return *reinterpret_cast<OpenFile*>(file); }
SimulatedDisk::State& Of(sqlite3_vfs* vfs) { return *static_cast<SimulatedDisk::State*>(vfs->pAppData); }

int Close(sqlite3_file* file) {
  delete Of(file).name;
  return SQLITE_OK;
}

int Read(sqlite3_file* file, void* to, int amount, sqlite3_int64 offset) {
  const OpenFile& open = Of(file);
  if (open.disk->dead) return SQLITE_IOERR_READ;
  const std::string& content = open.disk->files[*open.name].content;
  const auto begin = std::min(static_cast<std::size_t>(offset), content.size());
  const std::size_t there = std::min(static_cast<std::size_t>(amount), content.size() - begin);
  std::memcpy(to, content.data() + begin, there);
  if (there == static_cast<std::size_t>(amount)) return SQLITE_OK;
  std::memset(static_cast<char*>(to) + there, 0, static_cast<std::size_t>(amount) - there);
  return SQLITE_IOERR_SHORT_READ;
}

int Write(sqlite3_file* file, const void* from, int amount, sqlite3_int64 offset) {
  const OpenFile& open = Of(file);
  const Change change{{},
                      static_cast<std::uint64_t>(offset),
                      std::string(static_cast<const char*>(from), static_cast<std::size_t>(amount))};
  if (!open.disk->Live(*open.name, change)) return SQLITE_IOERR_WRITE;
  open.disk->Write(*open.name, change);
  return SQLITE_OK;
}

int Truncate(sqlite3_file* file, sqlite3_int64 size) {
  const OpenFile& open = Of(file);
  const Change change{static_cast<std::uint64_t>(size), 0, {}};
  if (!open.disk->Live(*open.name, change)) return SQLITE_IOERR_TRUNCATE;
  open.disk->Write(*open.name, change);
  return SQLITE_OK;
}

int Sync(sqlite3_file* file, int) {
  const OpenFile& open = Of(file);
  File& content = open.disk->files[*open.name];
  if (open.disk->dead) return SQLITE_IOERR_FSYNC;
  if (++open.disk->writes == open.disk->dies_at) {
    open.disk->dead = true;
    return SQLITE_IOERR_FSYNC;
  }
  content.synced = content.content;
  content.unsynced.clear();
  return SQLITE_OK;
}

int FileSize(sqlite3_file* file, sqlite3_int64* size) {
  const OpenFile& open = Of(file);
  if (open.disk->dead) return SQLITE_IOERR_FSTAT;
  *size = static_cast<sqlite3_int64>(open.disk->files[*open.name].content.size());
  return SQLITE_OK;
}

// One process has the disk.
int Lock(sqlite3_file*, int) { return SQLITE_OK; }
int CheckReservedLock(sqlite3_file*, int* reserved) {
  *reserved = 0;
  return SQLITE_OK;
}
int FileControl(sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; }
int SectorSize(sqlite3_file*) { return kSectorBytes; }
int DeviceCharacteristics(sqlite3_file*) { return 0; }

constexpr sqlite3_io_methods kMethods = {
    .iVersion = 1,  // no shared memory: the journal locks its file for itself
    .xClose = Close,
    .xRead = Read,
    .xWrite = Write,
    .xTruncate = Truncate,
    .xSync = Sync,
    .xFileSize = FileSize,
    .xLock = Lock,
    .xUnlock = Lock,
    .xCheckReservedLock = CheckReservedLock,
    .xFileControl = FileControl,
    .xSectorSize = SectorSize,
    .xDeviceCharacteristics = DeviceCharacteristics,
    .xShmMap = nullptr,
    .xShmLock = nullptr,
    .xShmBarrier = nullptr,
    .xShmUnmap = nullptr,
    .xFetch = nullptr,
    .xUnfetch = nullptr,
};

int Open(sqlite3_vfs* vfs, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  SimulatedDisk::State& disk = Of(vfs);
  file->pMethods = nullptr;
  if (disk.dead) return SQLITE_CANTOPEN;
  static std::atomic<int> unnamed{0};
  OpenFile& open = Of(file);
  open.disk = &disk;
  open.name = new std::string(name != nullptr ? name : "temporary " + std::to_string(++unnamed));
  (void)disk.files[*open.name];
  file->pMethods = &kMethods;
  if (out_flags != nullptr) *out_flags = flags;
  return SQLITE_OK;
}

int Delete(sqlite3_vfs* vfs, const char* name, int) {
  SimulatedDisk::State& disk = Of(vfs);
  if (disk.dead) return SQLITE_IOERR_DELETE;
  disk.files.erase(name);
  return SQLITE_OK;
}

int Access(sqlite3_vfs* vfs, const char* name, int, int* result) {
  SimulatedDisk::State& disk = Of(vfs);
  if (disk.dead) return SQLITE_IOERR_ACCESS;
  *result = disk.files.contains(name) ? 1 : 0;
  return SQLITE_OK;
}

int FullPathname(sqlite3_vfs*, const char* name, int size, char* path) {
  sqlite3_snprintf(size, path, "%s", name);
  return SQLITE_OK;
}

int Randomness(sqlite3_vfs* vfs, int amount, char* bytes) {
  for (int i = 0; i < amount; ++i) bytes[i] = static_cast<char>(Of(vfs).random.Int(0, 255));
  return amount;
}

int Sleep(sqlite3_vfs*, int microseconds) { return microseconds; }

int CurrentTime(sqlite3_vfs*, double* days) {
  *days = 2'460'000.5;
  return SQLITE_OK;
}

int LastError(sqlite3_vfs*, int, char*) { return 0; }

}  // namespace

SimulatedDisk::SimulatedDisk(std::uint64_t seed) : state_(std::make_unique<State>(seed)) {
  static std::atomic<int> disks{0};
  state_->name = "depthfarm-simulated-" + std::to_string(++disks);
  sqlite3_vfs& vfs = state_->vfs;
  vfs.iVersion = 1;
  vfs.szOsFile = sizeof(OpenFile);
  vfs.mxPathname = 512;
  vfs.zName = state_->name.c_str();
  vfs.pAppData = state_.get();
  vfs.xOpen = Open;
  vfs.xDelete = Delete;
  vfs.xAccess = Access;
  vfs.xFullPathname = FullPathname;
  vfs.xRandomness = Randomness;
  vfs.xSleep = Sleep;
  vfs.xCurrentTime = CurrentTime;
  vfs.xGetLastError = LastError;
  sqlite3_vfs_register(&vfs, 0);
}

SimulatedDisk::~SimulatedDisk() { sqlite3_vfs_unregister(&state_->vfs); }

const std::string& SimulatedDisk::vfs() const { return state_->name; }
void SimulatedDisk::DieAtWrite(int n) { state_->dies_at = n == 0 ? 0 : state_->writes + n; }
void SimulatedDisk::Die() { state_->dead = true; }
bool SimulatedDisk::dead() const { return state_->dead; }

void SimulatedDisk::Restart(Loss loss) {
  for (auto& [name, file] : state_->files) {
    if (loss == Loss::kPower) {
      file.content = file.synced;
      for (const Change& change : file.unsynced) {
        const int fate = state_->random.Int(0, 2);
        if (fate == 1 && !change.truncated) Apply(TornPart(change, state_->random), file.content);
        if (fate == 2) Apply(change, file.content);
      }
    }
    file.synced = file.content;
    file.unsynced.clear();
  }
  state_->dead = false;
  state_->dies_at = 0;
}

}  // namespace depthfarm::simulation
