// SPDX-License-Identifier: MIT
// Bodies of actor_points.hpp.
#pragma once

#include <motionlang/features/actor_points.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY ActorPoints parse_actor_points(std::string_view name) {
  for (std::size_t i = 0; i < actor_point_names.size(); ++i) {
    if (name == actor_point_names[i]) return static_cast<ActorPoints>(i);
  }
  raise<config_error>(103, "parse_actor_points: '", name, "' is not vertices, smpl, a2m, a2mpl or vibe");
}

MOTIONLANG_BODY std::span<const Index> actor_point_numbers(ActorPoints points) {
  static constexpr Index smpl[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11,
                                   12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23};
  static constexpr Index a2m[] = {0, 12, 17, 19, 21, 16, 18, 20, 24, 2, 5, 8, 1, 4, 7, 31, 34, 48};
  static constexpr Index a2mpl[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13,
                                    14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 31, 34, 48};
  static constexpr Index vibe[] = {24, 12, 17, 19, 21, 16, 18, 20, 0,  2,  5,  8,  1,  4,  7,  25, 26,
                                   27, 28, 29, 30, 31, 32, 33, 34, 8,  5,  45, 46, 4,  7,  21, 19, 17,
                                   16, 18, 20, 47, 48, 49, 50, 51, 52, 53, 24, 26, 25, 28, 27};
  switch (points) {
    case ActorPoints::smpl:
      return smpl;
    case ActorPoints::a2m:
      return a2m;
    case ActorPoints::a2mpl:
      return a2mpl;
    case ActorPoints::vibe:
      return vibe;
    default:
      return {};
  }
}

MOTIONLANG_NAMESPACE_END
