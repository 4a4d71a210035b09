// SPDX-License-Identifier: MIT
/// Draws a training item of SINC: an item as it is, or one combined with an action of other body parts.
///
///     const SincItems items(list_of_items, table);
///     const SincElement e = items.draw(k, {}, rng);
///     if (e.partner) use(compose_motions(motions[k], e.parts[0], motions[*e.partner], e.parts[1]));
///
/// Source   thesis B.2.1 and B.3.1; SINC (Athanasiou et al., ICCV 2023) sinc/data/babel.py load_keyid
#pragma once

#include <optional>       // elements without partner
#include <unordered_map>  // items by label

#include <motionlang/compose/body_part_answers.hpp>
#include <motionlang/features/frame_sampling.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The source of an item, the first word of its key: "seg", "seq", "spatial_pairs", "separate_pairs".
enum class SincSource { segment, sequence, simultaneous, pair };

struct SincItem {
  SincSource source = SincSource::segment;
  std::vector<std::string> labels;
  Index frames = 0;
};

struct SincDrawOptions {
  double proportion = 0.5;  // share of single actions that get a partner
  bool synthetic = true;
  bool random = false;  // any partner, any parts: the ablation
  SincWindow window{};
};

struct SincElement {
  std::optional<Index> partner;     // number of the item that is combined with this one
  std::vector<std::string> labels;  // of the item; with a partner: the first one of each
  std::vector<SincParts> parts;     // of each label
  FrameSlice window;                // of the item; a combined one is not cut
};

/// Philox and other generators of single numbers: uniform in [0, 1), and below n.
template <class G>
concept UniformDraws = requires(G& g, std::uint32_t n) {
  { g.uniform() } -> std::convertible_to<double>;
  { g.below(n) } -> std::integral;
};

/// All items, and their possible partners. Holds a table of parts by reference.
class SincItems {
 public:
  SincItems(std::vector<SincItem> items, const BodyPartTable& table);

  /// Single actions whose first label moves no part that the first label of item k moves. They are ordered by label, as
  /// in the table, then as they came. Throws config_error 103 for a label without parts.
  std::vector<Index> partners(Index k) const;

  /// Draws in this order: if there is to be a partner (for every item), the partner, twelve bits in random mode, the
  /// window. Throws config_error 101 for a number that is not an item, 103 for a label without parts.
  template <UniformDraws G>
  SincElement draw(Index k, const SincDrawOptions& options, G& rng) const {
    const SincItem& item = at(k);
    SincElement out{std::nullopt, item.labels, {}, {}};
    const double u = rng.uniform();
    if (options.synthetic && u < options.proportion && is_single(item)) {
      const std::vector<Index> candidates = options.random ? not_simultaneous_ : partners(k);
      if (!candidates.empty()) out.partner = candidates[static_cast<std::size_t>(below(rng, std::ssize(candidates)))];
    }
    if (out.partner) out.labels = {item.labels.front(), at(*out.partner).labels.front()};
    for (const std::string& label : out.labels) {
      SincParts& parts = out.parts.emplace_back();
      if (!out.partner || !options.random) {
        parts = table_->parts(label);
      } else {
        for (std::size_t p = 0; p < sinc_part_count; ++p) parts[p] = below(rng, 2) == 1;
      }
    }
    out.window = options.window.of(item.frames, [&](Index n) { return below(rng, n); });
    return out;
  }

 private:
  static bool is_single(const SincItem& item) {
    return item.source == SincSource::segment || item.source == SincSource::sequence;
  }
  template <class G>
  static Index below(G& rng, Index n) {
    return static_cast<Index>(rng.below(static_cast<std::uint32_t>(n)));
  }
  const SincItem& at(Index k) const;

  std::vector<SincItem> items_;
  const BodyPartTable* table_;
  std::unordered_map<std::string, std::vector<Index>> singles_;  // by their first label
  std::vector<Index> not_simultaneous_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/sinc_items.ipp>
#endif
