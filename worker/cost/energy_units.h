#ifndef DEPTHFARM_WORKER_COST_ENERGY_UNITS_H_
#define DEPTHFARM_WORKER_COST_ENERGY_UNITS_H_

#include <cstdint>

namespace depthfarm {

// E of eq. (1) is an integer: sums come out the same in every order and on every machine.
//
// 1152 units are one grey level (of the L1 sum over Y, Cb, Cr that eqs. (3) and (4) use). Matching costs are whole
// steps of 1/9 grey level, exact for the 3x3 window; smoothing coefficients are even numbers of units, fine enough for
// the weakest link (765 grey levels apart: 1.5 units). Both are even, so that the halves of the symmetric normal form
// (see optimization/expansion.h) are whole.
inline constexpr std::int32_t kEnergyUnitsPerGrey = 1152;
inline constexpr std::int32_t kMatchStepsPerGrey = 9;
inline constexpr std::int32_t kEnergyUnitsPerMatchStep = kEnergyUnitsPerGrey / kMatchStepsPerGrey;

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_COST_ENERGY_UNITS_H_
