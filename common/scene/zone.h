#ifndef DEPTHFARM_COMMON_SCENE_ZONE_H_
#define DEPTHFARM_COMMON_SCENE_ZONE_H_

#include <array>
#include <cstdint>
#include <string_view>

namespace depthfarm {

// What kind of surface a pixel of a rendered scene shows: depth estimation fails differently on each, so quality
// figures are told zone by zone. The values are those of ZoneMap and of the zone pictures on disk.
enum class Zone : std::uint8_t {
  kUnknown = 0,   // no surface
  kTextured = 1,  // textured wall and other ordinary surfaces
  kSlanted = 2,   // floor and side wall: depth changes within a segment
  kCurved = 3,
  kThin = 4,    // pole, rod, railing: a few pixels wide
  kPerson = 5,  // moves over the frames
  kPanel = 6,   // plain, textureless
  kBox = 7,     // sharp depth edges
};

inline constexpr std::array<Zone, 7> kSurfaceZones = {Zone::kTextured, Zone::kSlanted, Zone::kCurved, Zone::kThin,
                                                      Zone::kPerson,   Zone::kPanel,   Zone::kBox};

// Stable lower-case word for files and reports, e.g. "textured"; "unknown" for anything else.
[[nodiscard]] constexpr std::string_view ZoneName(Zone zone) {
  switch (zone) {
    case Zone::kTextured:
      return "textured";
    case Zone::kSlanted:
      return "slanted";
    case Zone::kCurved:
      return "curved";
    case Zone::kThin:
      return "thin";
    case Zone::kPerson:
      return "person";
    case Zone::kPanel:
      return "panel";
    case Zone::kBox:
      return "box";
    case Zone::kUnknown:
      break;
  }
  return "unknown";
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SCENE_ZONE_H_
