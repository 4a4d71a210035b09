// SPDX-License-Identifier: MIT
// Bodies of known_systems.hpp.
#pragma once

#include <motionlang/weights/known_systems.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::array<WeightsPlace, 2> lightning_places{
    {{"logs/checkpoints", {"last.ckpt"}, "latest-epoch=", ".ckpt"},
     {"checkpoints", {"last.ckpt"}, "latest-epoch=", ".ckpt"}}};

inline constexpr std::array<KnownSystem, 9> system_table{{
    {.name = "stmc", .title = "STMC", .diffusion = true, .weights = lightning_places},
    {.name = "mdm",
     .title = "MDM",
     .diffusion = true,
     .weights = {{{"", {}, "model0", ".pt"}, {"", {}, "model", ".pt"}}}},
    {.name = "motiondiffuse",
     .title = "MotionDiffuse",
     .diffusion = true,
     .weights = {{{"model", {"latest.tar"}, "ckpt_", ".tar"}, {"", {"latest.tar"}, "ckpt_", ".tar"}}}},
    {.name = "actor",
     .title = "ACTOR",
     .trained_generates = true,
     .weights = {{{"", {}, "checkpoint_", ".pth.tar"}, {"", {}, "retraincheckpoint_", ".pth.tar"}}}},
    {.name = "temos", .title = "TEMOS", .trained_generates = true, .weights = lightning_places},
    {.name = "teach", .title = "TEACH", .folder_of = "temos", .trained_generates = true},
    {.name = "sinc", .title = "SINC", .folder_of = "temos", .trained_generates = true},
    {.name = "tmr", .title = "TMR", .trained_generates = true, .modules = true, .weights = lightning_places},
    {.name = "tm2t",
     .title = "TM2T",
     .weights = {{{"model", {"finest.tar", "latest.tar"}, "E", ".tar"},
                  {"", {"finest.tar", "latest.tar"}, "E", ".tar"}}}},
}};

}  // namespace detail

MOTIONLANG_BODY std::span<const KnownSystem> known_systems() { return detail::system_table; }

MOTIONLANG_BODY const KnownSystem* known_system(std::string_view name) {
  for (const KnownSystem& s : known_systems()) {
    if (s.name == name) return &s;
  }
  return nullptr;
}

MOTIONLANG_BODY bool is_diffusion_system(std::string_view name) {
  const KnownSystem* const known = known_system(name);
  return known != nullptr && known->diffusion;
}

MOTIONLANG_NAMESPACE_END
