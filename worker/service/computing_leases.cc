#include "worker/service/computing_leases.h"

#include <sys/mman.h>

#include <cerrno>
#include <memory>
#include <system_error>

namespace depthfarm {

Result<std::unique_ptr<ComputingLeases>> ComputingLeases::Make(int slots) {
  const std::size_t count = static_cast<std::size_t>(slots);
  void* memory = ::mmap(nullptr, count * sizeof(Cell), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED)
    return Unavailable("cannot share memory with the worker's process: " + std::generic_category().message(errno));
  Cell* cells = static_cast<Cell*>(memory);
  std::uninitialized_value_construct_n(cells, count);
  return std::unique_ptr<ComputingLeases>(new ComputingLeases({cells, count}));
}

ComputingLeases::~ComputingLeases() { (void)::munmap(leases_.data(), leases_.size_bytes()); }

std::vector<LeaseId> ComputingLeases::List() const {
  std::vector<LeaseId> list;
  for (const Cell& lease : leases_) {
    if (const std::uint64_t value = lease; value != 0) list.emplace_back(value);
  }
  return list;
}

}  // namespace depthfarm
