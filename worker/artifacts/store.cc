#include "worker/artifacts/store.h"

#include <algorithm>
#include <new>
#include <set>
#include <system_error>
#include <utility>

#include "common/digest/sha256.h"
#include "worker/artifacts/artifact_digest.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

std::uint64_t FileBytes(const ArtifactInfo& info) { return kStoreFileHeaderBytes + info.stored_bytes; }

Status NoSuchArtifact(const ArtifactKey& key) { return Unavailable("artifact " + Hex(key) + ": not in this store"); }

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
  DEPTHFARM_ASSIGN_OR_RETURN(std::unique_ptr<SharedFolder> shared, SharedFolder::Open(folder));
  std::unique_ptr<ArtifactStore> store(new ArtifactStore(std::move(folder), max_bytes, std::move(shared)));
  DEPTHFARM_RETURN_IF_ERROR(store->Scan());
  return store;
}

Status ArtifactStore::Scan() {
  const std::scoped_lock lock(mutex_);
  {
    DEPTHFARM_ASSIGN_OR_RETURN(SharedFolder::Change change, folder_->Begin());
    std::vector<ArtifactKey> removed;
    // What others pin may be more than this one's bound: it stays for now.
    (void)change.MakeRoom(0, max_bytes_, removed).ok();
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<SharedFolder::StoredFile> files, folder_->List());
  std::vector<ArtifactKey> damaged;
  for (const SharedFolder::StoredFile& file : files) {
    const std::string path = folder_->PathOf(file.key).string();
    const Result<StoreFileHeader> header = ReadStoreFileHeader(path);
    if (header.ok()) {
      Insert({file.key, header->bytes, header->content_digest}, header->file, false);
    } else if (IdOfFile(path).has_value()) {
      damaged.push_back(file.key);
    }
  }
  if (damaged.empty()) return {};
  DEPTHFARM_ASSIGN_OR_RETURN(SharedFolder::Change change, folder_->Begin());
  for (const ArtifactKey& key : damaged) {
    if (!ReadStoreFileHeader(folder_->PathOf(key).string()).ok()) change.Remove(key);
  }
  return {};
}

Result<ArtifactInfo> ArtifactStore::Put(const ArtifactKey& key, std::string_view artifact) {
  const ArtifactInfo info{key, artifact.size(), DigestOfArtifact(artifact)};
  DEPTHFARM_RETURN_IF_ERROR(PutVerified(info, artifact));
  return info;
}

Status ArtifactStore::PutVerified(const ArtifactInfo& info, std::string_view artifact) {
  bool to_verify = false;
  {
    const std::scoped_lock lock(mutex_);
    if (const auto known = Look(info.key); known != entries_.end() && known->second.info == info) {
      to_verify = !known->second.verified;
      if (!to_verify) {
        folder_->Touch(info.key);
        return {};
      }
    }
  }
  // Another worker, or one before this, has made the same.
  if (to_verify && Verify(info).ok()) return {};
  if (FileBytes(info) > max_bytes_) {
    return Unavailable("artifact of " + std::to_string(FileBytes(info)) + " bytes: the store is bounded to " +
                       std::to_string(max_bytes_) + " bytes: raise --cache-size");
  }
  const fs::path path = folder_->PathOf(info.key);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) return Unavailable(path.string() + ": cannot make its folder: " + error.message());
  const std::string written_as = folder_->TemporaryFor(info.key);
  Status status = WriteStoreFile(written_as, info.content_digest, artifact);
  if (status.ok()) status = Accept(info, written_as);
  fs::remove(written_as, error);  // if it was not taken
  return status;
}

Status ArtifactStore::Accept(const ArtifactInfo& info, const std::string& written_as) {
  const std::scoped_lock lock(mutex_);
  DEPTHFARM_ASSIGN_OR_RETURN(SharedFolder::Change change, folder_->Begin());
  if (const auto there = Look(info.key); there != entries_.end() && there->second.info == info) {
    // Another worker was faster. Its file stays in place, since somebody may be about to read it.
    folder_->Touch(info.key);
    return {};
  }
  const bool there_was_one = entries_.erase(info.key) > 0;
  change.Remove(info.key);
  std::vector<ArtifactKey> removed;
  Status status = change.MakeRoom(FileBytes(info), max_bytes_, removed);
  for (const ArtifactKey& key : removed) Forget(key);
  if (status.ok()) status = change.Add(info.key, written_as);
  const std::optional<FileId> file = IdOfFile(folder_->PathOf(info.key).string());
  if (status.ok() && file) {
    Insert(info, *file, true);
  } else if (there_was_one) {
    dropped_.push_back(info.key);
  }
  return status;
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
  DEPTHFARM_ASSIGN_OR_RETURN(const FileId file, FileOf(info));
  const std::uint64_t count = std::min(max_bytes, info.stored_bytes - offset);
  // One that another worker evicted or replaced just now is asked for again, and then looked at anew.
  DEPTHFARM_ASSIGN_OR_RETURN(std::string data, chunk_memory_.Take(static_cast<std::size_t>(count)));
  DEPTHFARM_RETURN_IF_ERROR(ReadStoreFileBytes(folder_->PathOf(key).string(), file, offset, data));
  return ArtifactChunk{info.stored_bytes, chunk_memory_.Share(std::move(data))};
}

Result<ArtifactInfo> ArtifactStore::Verified(const ArtifactKey& key) {
  ArtifactInfo info;
  {
    const std::scoped_lock lock(mutex_);
    const auto entry = Look(key);
    if (entry == entries_.end()) return NoSuchArtifact(key);
    folder_->Touch(key);
    info = entry->second.info;
    if (entry->second.verified) return info;
  }
  DEPTHFARM_RETURN_IF_ERROR(Verify(info));
  return info;
}

Result<std::string> ArtifactStore::ReadAndVerify(const ArtifactInfo& info) {
  DEPTHFARM_ASSIGN_OR_RETURN(const FileId file, FileOf(info));
  std::string bytes;
  try {
    bytes.resize(static_cast<std::size_t>(info.stored_bytes));
  } catch (const std::bad_alloc&) {
    return Unavailable("artifact " + Hex(info.key) + ": no memory for its " + std::to_string(info.stored_bytes) +
                       " bytes");
  }
  const Status read = ReadStoreFileBytes(folder_->PathOf(info.key).string(), file, 0, bytes);
  DEPTHFARM_RETURN_IF_ERROR(Judge(info, file, read.ok() ? Result<ContentDigest>(DigestOfArtifact(bytes)) : read));
  return bytes;
}

Status ArtifactStore::Verify(const ArtifactInfo& info) {
  DEPTHFARM_ASSIGN_OR_RETURN(const FileId file, FileOf(info));
  return Judge(info, file, DigestOfStoreFile(folder_->PathOf(info.key).string(), file));
}

Result<FileId> ArtifactStore::FileOf(const ArtifactInfo& info) {
  const std::scoped_lock lock(mutex_);
  const auto entry = entries_.find(info.key);
  if (entry == entries_.end() || entry->second.info != info) return NoSuchArtifact(info.key);
  return entry->second.file;
}

Status ArtifactStore::Judge(const ArtifactInfo& info, const FileId& file, const Result<ContentDigest>& digest) {
  const bool right = digest.ok() && *digest == info.content_digest;
  const std::scoped_lock lock(mutex_);
  const auto entry = Look(info.key);
  const bool current = entry != entries_.end() && entry->second.info == info && entry->second.file == file;
  if (right) {
    if (current) {
      entry->second.verified = true;
      folder_->Touch(info.key);
    }
    return {};
  }
  // One that was evicted or replaced while its file was read is no damage.
  if (!current) return NoSuchArtifact(info.key);
  Evict(info.key);
  if (!digest.ok()) return digest.status();
  return Corrupt("artifact " + Hex(info.key) + ": its file does not match its digest; dropped");
}

ArtifactStore::Entries::iterator ArtifactStore::Look(const ArtifactKey& key) {
  const std::string path = folder_->PathOf(key).string();
  const std::optional<FileId> there = IdOfFile(path);
  const auto known = entries_.find(key);
  if (known != entries_.end() && there == known->second.file) return known;
  if (known != entries_.end()) Forget(key);
  if (!there) return entries_.end();
  const Result<StoreFileHeader> header = ReadStoreFileHeader(path);
  if (!header.ok()) return entries_.end();
  Insert({key, header->bytes, header->content_digest}, header->file, false);
  return entries_.find(key);
}

std::optional<ArtifactInfo> ArtifactStore::Find(const ArtifactKey& key) {
  const std::scoped_lock lock(mutex_);
  const auto entry = Look(key);
  if (entry == entries_.end()) return std::nullopt;
  return entry->second.info;
}

std::vector<ArtifactInfo> ArtifactStore::List() {
  const std::scoped_lock lock(mutex_);
  std::vector<ArtifactKey> keys;
  for (const auto& [key, entry] : entries_) keys.push_back(key);
  std::vector<ArtifactInfo> list;
  list.reserve(keys.size());
  for (const ArtifactKey& key : keys) {
    if (const auto entry = Look(key); entry != entries_.end()) list.push_back(entry->second.info);
  }
  return list;
}

std::uint64_t ArtifactStore::total_bytes() {
  const std::scoped_lock lock(mutex_);
  const Result<SharedFolder::Change> change = folder_->Begin();
  return change.ok() ? change->bytes() : 0;
}

ArtifactPins ArtifactStore::Pin(std::vector<ArtifactKey> keys) {
  const std::scoped_lock lock(mutex_);
  for (const ArtifactKey& key : keys) ++pins_[key];
  TellPins();
  return {this, std::move(keys)};
}

void ArtifactStore::Unpin(const std::vector<ArtifactKey>& keys) {
  const std::scoped_lock lock(mutex_);
  for (const ArtifactKey& key : keys) {
    const auto pin = pins_.find(key);
    if (pin != pins_.end() && --pin->second == 0) pins_.erase(pin);
  }
  TellPins();
}

void ArtifactStore::TellPins() {
  std::set<ArtifactKey> keys;
  for (const auto& [key, count] : pins_) keys.insert(keys.end(), key);
  folder_->SetPins(keys);
}

void ArtifactStore::Release(const std::vector<ArtifactKey>& keys) {
  {
    const std::scoped_lock lock(mutex_);
    for (const ArtifactKey& key : keys) kept_.erase(key);
  }
  SetRank(keys, SharedFolder::Rank::kReleased);
}

void ArtifactStore::Keep(const std::vector<ArtifactKey>& keys) {
  {
    const std::scoped_lock lock(mutex_);
    kept_.insert(keys.begin(), keys.end());
  }
  SetRank(keys, SharedFolder::Rank::kKept);
}

void ArtifactStore::KeepNone() {
  std::vector<ArtifactKey> kept;
  {
    const std::scoped_lock lock(mutex_);
    kept.assign(kept_.begin(), kept_.end());
    kept_.clear();
  }
  SetRank(kept, SharedFolder::Rank::kUsed);
}

void ArtifactStore::SetRank(const std::vector<ArtifactKey>& keys, SharedFolder::Rank rank) {
  if (keys.empty()) return;
  const std::scoped_lock lock(mutex_);
  Result<SharedFolder::Change> change = folder_->Begin();
  if (!change.ok()) return;  // then they go in another order
  for (const ArtifactKey& key : keys) change->SetRank(key, rank);
}

void ArtifactStore::Drop(const ArtifactKey& key) {
  const std::scoped_lock lock(mutex_);
  if (Look(key) != entries_.end()) Evict(key);
}

std::vector<ArtifactKey> ArtifactStore::TakeDropped() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(dropped_, {});
}

void ArtifactStore::Insert(const ArtifactInfo& info, const FileId& file, bool verified) {
  entries_[info.key] = {.info = info, .file = file, .verified = verified};
  // It is there again: telling of its loss now would be about this one.
  std::erase(dropped_, info.key);
}

void ArtifactStore::Forget(const ArtifactKey& key) {
  kept_.erase(key);
  if (entries_.erase(key) > 0) dropped_.push_back(key);
}

void ArtifactStore::Evict(const ArtifactKey& key) {
  if (Result<SharedFolder::Change> change = folder_->Begin(); change.ok()) change->Remove(key);
  Forget(key);
}

}  // namespace depthfarm
