#include "worker/artifacts/store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "common/digest/sha256.h"
#include "worker/artifacts/store_file.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNameLength = 2 * std::tuple_size_v<ArtifactKey>;
constexpr std::string_view kHexDigits = "0123456789abcdef";

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

// A file that WriteFileAtomically left when its process was killed: a key and more.
bool IsLeftover(std::string_view name) {
  return name.size() > kNameLength && name[kNameLength] == '.' && KeyOf(name.substr(0, kNameLength)).has_value();
}

std::uint64_t FileBytes(const ArtifactInfo& info) { return kStoreFileHeaderBytes + info.stored_bytes; }

void RemoveFile(const fs::path& path) {
  std::error_code ignored;  // a file that stays is found again, and removed, at the next start
  fs::remove(path, ignored);
}

Status NoSuchArtifact(const ArtifactKey& key) { return Unavailable("artifact " + Hex(key) + ": not in this store"); }

// -1 when another process has it.
Result<int> LockFolder(const fs::path& folder) {
  const std::string path = (folder / "lock").string();
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file < 0) return Unavailable(path + ": cannot open: " + std::generic_category().message(errno));
  if (flock(file, LOCK_EX | LOCK_NB) != 0) {
    const std::string reason = std::generic_category().message(errno);
    close(file);
    return Unavailable(folder.string() + ": in use by another worker (" + reason + "): name another --cache-dir");
  }
  return file;
}

}  // namespace

ArtifactPins::ArtifactPins(ArtifactPins&& other) noexcept
    : store_(std::exchange(other.store_, nullptr)), keys_(std::move(other.keys_)) {}

ArtifactPins& ArtifactPins::operator=(ArtifactPins&& other) noexcept {
  if (this != &other) {
    Unpin();
    store_ = std::exchange(other.store_, nullptr);
    keys_ = std::move(other.keys_);
  }
  return *this;
}

ArtifactPins::~ArtifactPins() { Unpin(); }

void ArtifactPins::Unpin() {
  if (store_ != nullptr) store_->Unpin(keys_);
}

Result<std::unique_ptr<ArtifactStore>> ArtifactStore::Open(fs::path folder, std::uint64_t max_bytes) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Unavailable(folder.string() + ": cannot make the folder: " + error.message());
  DEPTHFARM_ASSIGN_OR_RETURN(const int lock_file, LockFolder(folder));
  std::unique_ptr<ArtifactStore> store(new ArtifactStore(std::move(folder), max_bytes, lock_file));
  DEPTHFARM_RETURN_IF_ERROR(store->Scan());
  return store;
}

ArtifactStore::ArtifactStore(fs::path folder, std::uint64_t max_bytes, int lock_file)
    : folder_(std::move(folder)), max_bytes_(max_bytes), lock_file_(lock_file) {}

ArtifactStore::~ArtifactStore() { close(lock_file_); }

Status ArtifactStore::Scan() {
  struct Found {
    fs::file_time_type written;
    ArtifactInfo info;
  };
  std::vector<Found> found;
  std::error_code error;
  fs::recursive_directory_iterator files(folder_, error);
  for (; !error && files != fs::recursive_directory_iterator(); files.increment(error)) {
    const fs::path& path = files->path();
    const std::string name = path.filename().string();
    if (IsLeftover(name)) RemoveFile(path);
    const std::optional<ArtifactKey> key = KeyOf(name);
    if (!key.has_value() || path != PathOf(*key)) continue;
    const Result<StoreFileHeader> header = ReadStoreFileHeader(path.string());
    std::error_code no_time;
    const fs::file_time_type written = fs::last_write_time(path, no_time);
    if (!header.ok() || no_time) {
      RemoveFile(path);
      continue;
    }
    found.push_back({written, {*key, header->bytes, header->content_digest}});
  }
  if (error) return Unavailable(folder_.string() + ": cannot list the folder: " + error.message());
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return a.written != b.written ? a.written < b.written : a.info.key < b.info.key;
  });
  const std::scoped_lock lock(mutex_);
  for (const Found& file : found) {
    total_bytes_ += FileBytes(file.info);
    Insert(file.info, false);
  }
  DEPTHFARM_RETURN_IF_ERROR(MakeRoom(0));
  dropped_.clear();
  return {};
}

fs::path ArtifactStore::PathOf(const ArtifactKey& key) const {
  const std::string name = Hex(key);
  return folder_ / name.substr(0, 2) / name.substr(2, 2) / name;
}

Result<ArtifactInfo> ArtifactStore::Put(const ArtifactKey& key, std::string_view artifact) {
  const ArtifactInfo info{key, artifact.size(), Sha256(artifact)};
  DEPTHFARM_RETURN_IF_ERROR(PutVerified(info, artifact));
  return info;
}

Status ArtifactStore::PutVerified(const ArtifactInfo& info, std::string_view artifact) {
  const ArtifactKey& key = info.key;
  const std::uint64_t needed = FileBytes(info);
  bool there_was_one = false;
  {
    const std::scoped_lock lock(mutex_);
    const auto known = entries_.find(key);
    there_was_one = known != entries_.end();
    if (there_was_one && known->second.verified && known->second.info == info) {
      Touch(known->second);
      return {};
    }
    Erase(key);
    if (const Status room = MakeRoom(needed); !room.ok()) {
      if (there_was_one) dropped_.push_back(key);
      return room;
    }
    total_bytes_ += needed;  // reserved, so that nothing else takes the room while the file is written
  }
  const fs::path path = PathOf(key);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  const Status written = error ? Unavailable(path.string() + ": cannot make its folder: " + error.message())
                               : WriteStoreFile(path.string(), info.content_digest, artifact);
  const std::scoped_lock lock(mutex_);
  if (!written.ok()) {
    total_bytes_ -= needed;
    if (there_was_one) dropped_.push_back(key);
    return written;
  }
  if (const auto other = entries_.find(key); other != entries_.end()) {
    // Stored twice at the same time: one file, the one renamed last; its digest decides which of the two it is.
    total_bytes_ -= FileBytes(other->second.info);
    OrderOf(other->second.rank).erase(other->second.use);
    entries_.erase(other);
  }
  Insert(info, true);
  return {};
}

Result<std::string> ArtifactStore::Get(const ArtifactKey& key) {
  const std::optional<ArtifactInfo> info = Find(key);
  if (!info.has_value()) return NoSuchArtifact(key);
  return ReadAndVerify(*info);
}

Result<ArtifactChunk> ArtifactStore::ReadChunk(const ArtifactKey& key, std::uint64_t offset, std::uint64_t max_bytes) {
  DEPTHFARM_ASSIGN_OR_RETURN(const ArtifactInfo info, Verified(key));
  if (offset > info.stored_bytes) {
    return InvalidArgument("artifact " + Hex(key) + ": offset " + std::to_string(offset) + " is past its " +
                           std::to_string(info.stored_bytes) + " bytes");
  }
  const std::uint64_t count = std::min(max_bytes, info.stored_bytes - offset);
  DEPTHFARM_ASSIGN_OR_RETURN(std::string data, ReadStoreFileBytes(PathOf(key).string(), offset, count));
  return ArtifactChunk{info.stored_bytes, std::move(data)};
}

Result<ArtifactInfo> ArtifactStore::Verified(const ArtifactKey& key) {
  ArtifactInfo info;
  {
    const std::scoped_lock lock(mutex_);
    const auto entry = entries_.find(key);
    if (entry == entries_.end()) return NoSuchArtifact(key);
    Touch(entry->second);
    info = entry->second.info;
    if (entry->second.verified) return info;
  }
  DEPTHFARM_RETURN_IF_ERROR(ReadAndVerify(info).status());
  return info;
}

Result<std::string> ArtifactStore::ReadAndVerify(const ArtifactInfo& info) {
  Result<std::string> bytes = ReadStoreFileBytes(PathOf(info.key).string(), 0, info.stored_bytes);
  const bool right = bytes.ok() && Sha256(*bytes) == info.content_digest;
  const std::scoped_lock lock(mutex_);
  const auto entry = entries_.find(info.key);
  const bool current = entry != entries_.end() && entry->second.info == info;
  if (right) {
    if (current) {
      entry->second.verified = true;
      Touch(entry->second);
    }
    return bytes;
  }
  // An entry that was evicted or replaced while its file was read is no damage.
  if (!current) return NoSuchArtifact(info.key);
  Evict(info.key);
  if (!bytes.ok()) return bytes.status();
  return Corrupt("artifact " + Hex(info.key) + ": its file does not match its digest; dropped");
}

std::optional<ArtifactInfo> ArtifactStore::Find(const ArtifactKey& key) const {
  const std::scoped_lock lock(mutex_);
  const auto entry = entries_.find(key);
  if (entry == entries_.end()) return std::nullopt;
  return entry->second.info;
}

std::vector<ArtifactInfo> ArtifactStore::List() const {
  const std::scoped_lock lock(mutex_);
  std::vector<ArtifactInfo> list;
  list.reserve(entries_.size());
  for (const auto& [key, entry] : entries_) list.push_back(entry.info);
  return list;
}

std::uint64_t ArtifactStore::total_bytes() const {
  const std::scoped_lock lock(mutex_);
  return total_bytes_;
}

ArtifactPins ArtifactStore::Pin(std::vector<ArtifactKey> keys) {
  const std::scoped_lock lock(mutex_);
  for (const ArtifactKey& key : keys) ++pins_[key];
  return {this, std::move(keys)};
}

void ArtifactStore::Unpin(const std::vector<ArtifactKey>& keys) {
  const std::scoped_lock lock(mutex_);
  for (const ArtifactKey& key : keys) {
    const auto pin = pins_.find(key);
    if (pin != pins_.end() && --pin->second == 0) pins_.erase(pin);
  }
}

void ArtifactStore::Release(const std::vector<ArtifactKey>& keys) { SetRank(keys, Rank::kReleased); }

void ArtifactStore::Keep(const std::vector<ArtifactKey>& keys) { SetRank(keys, Rank::kKept); }

void ArtifactStore::KeepNone() {
  std::vector<ArtifactKey> kept;
  {
    const std::scoped_lock lock(mutex_);
    kept.assign(OrderOf(Rank::kKept).begin(), OrderOf(Rank::kKept).end());
  }
  SetRank(kept, Rank::kUsed);
}

void ArtifactStore::SetRank(const std::vector<ArtifactKey>& keys, Rank rank) {
  const std::scoped_lock lock(mutex_);
  for (const ArtifactKey& key : keys) {
    const auto found = entries_.find(key);
    if (found == entries_.end() || found->second.rank == rank) continue;
    OrderOf(rank).splice(OrderOf(rank).end(), OrderOf(found->second.rank), found->second.use);
    found->second.rank = rank;
  }
}

void ArtifactStore::Drop(const ArtifactKey& key) {
  const std::scoped_lock lock(mutex_);
  if (entries_.contains(key)) Evict(key);
}

std::vector<ArtifactKey> ArtifactStore::TakeDropped() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(dropped_, {});
}

void ArtifactStore::Insert(const ArtifactInfo& info, bool verified) {
  std::list<ArtifactKey>& order = OrderOf(Rank::kUsed);
  Entry entry{.info = info, .verified = verified, .rank = Rank::kUsed, .use = order.insert(order.end(), info.key)};
  entries_.emplace(info.key, entry);
}

void ArtifactStore::Touch(Entry& entry) {
  std::list<ArtifactKey>& order = OrderOf(entry.rank);
  order.splice(order.end(), order, entry.use);
}

void ArtifactStore::Erase(const ArtifactKey& key) {
  const auto found = entries_.find(key);
  if (found == entries_.end()) return;
  RemoveFile(PathOf(key));
  total_bytes_ -= FileBytes(found->second.info);
  OrderOf(found->second.rank).erase(found->second.use);
  entries_.erase(found);
}

void ArtifactStore::Evict(const ArtifactKey& key) {
  Erase(key);
  dropped_.push_back(key);
}

Status ArtifactStore::MakeRoom(std::uint64_t needed) {
  if (needed > max_bytes_) {
    return Unavailable("artifact of " + std::to_string(needed) + " bytes: the store is bounded to " +
                       std::to_string(max_bytes_) + " bytes: raise --cache-size");
  }
  while (total_bytes_ > max_bytes_ - needed) {
    const std::optional<ArtifactKey> victim = NextVictim();
    if (!victim.has_value()) {
      return Unavailable("artifact of " + std::to_string(needed) + " bytes: all " + std::to_string(total_bytes_) +
                         " bytes in the store of " + std::to_string(max_bytes_) +
                         " belong to running tasks: raise --cache-size");
    }
    Evict(*victim);
  }
  return {};
}

std::optional<ArtifactKey> ArtifactStore::NextVictim() const {
  for (const std::list<ArtifactKey>& order : orders_) {
    const auto victim =
        std::find_if(order.begin(), order.end(), [this](const ArtifactKey& key) { return !pins_.contains(key); });
    if (victim != order.end()) return *victim;
  }
  return std::nullopt;
}

}  // namespace depthfarm
