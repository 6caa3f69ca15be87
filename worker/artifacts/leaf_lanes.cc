#include "worker/artifacts/leaf_lanes.h"

#include <intel-ipsec-mb.h>

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "common/digest/sha256.h"
#include "worker/artifacts/leaf_digests.h"

namespace depthfarm {
namespace {

constexpr std::size_t kDigestBytes = Sha256Digest{}.size();

struct FreeManager {
  void operator()(IMB_MGR* manager) const { free_mb_mgr(manager); }
};
using Manager = std::unique_ptr<IMB_MGR, FreeManager>;

// Null when there is no memory, or nothing that the library could use on this processor.
Manager MakeManager() {
  Manager manager(alloc_mb_mgr(0));
  if (!manager) return nullptr;
  IMB_ARCH chosen = IMB_ARCH_NONE;
  init_mb_mgr_auto(manager.get(), &chosen);
  if (chosen == IMB_ARCH_NONE || imb_get_errno(manager.get()) != 0) return nullptr;
  return manager;
}

// Managers that nobody uses: one takes 200 KB and 0.1 ms to be made, as long as half a MiB takes to be hashed.
class IdleManagers {
 public:
  Manager Take() {
    {
      const std::scoped_lock lock(mutex_);
      if (!idle_.empty()) {
        Manager manager = std::move(idle_.back());
        idle_.pop_back();
        return manager;
      }
    }
    return MakeManager();
  }
  void GiveBack(Manager manager) {
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(manager));
  }

 private:
  std::mutex mutex_;
  std::vector<Manager> idle_;  // as many as were ever used at once
};

void AppendSideBySide(IMB_MGR& manager, std::string_view leaves, std::string& digests) {
  const std::size_t before = digests.size();
  digests.resize(before + leaves.size() / kLeafBytes * kDigestBytes);
  auto* result = reinterpret_cast<std::uint8_t*>(digests.data() + before);
  for (; !leaves.empty(); leaves.remove_prefix(kLeafBytes), result += kDigestBytes) {
    IMB_JOB* const job = IMB_GET_NEXT_JOB(&manager);
    *job = IMB_JOB{};
    job->cipher_mode = IMB_CIPHER_NULL;
    job->cipher_direction = IMB_DIR_ENCRYPT;
    job->chain_order = IMB_ORDER_HASH_CIPHER;
    job->hash_alg = IMB_AUTH_SHA_256;
    job->src = reinterpret_cast<const std::uint8_t*>(leaves.data());
    job->msg_len_to_hash_in_bytes = kLeafBytes;
    job->auth_tag_output = result;
    job->auth_tag_output_len_in_bytes = kDigestBytes;
    IMB_SUBMIT_JOB(&manager);
    // Only a job that is filled in wrongly fails.
    if (imb_get_errno(&manager) != 0) std::abort();
  }
  while (IMB_FLUSH_JOB(&manager) != nullptr) continue;
}

}  // namespace

bool AppendInLanes(std::string_view leaves, std::string& digests) {
  static IdleManagers idle;
  Manager manager = idle.Take();
  if (!manager) return false;
  AppendSideBySide(*manager, leaves, digests);
  idle.GiveBack(std::move(manager));
  return true;
}

}  // namespace depthfarm
