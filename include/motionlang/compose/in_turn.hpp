// SPDX-License-Identifier: MIT
/// Splits sentences of several actions into texts that follow each other in a timeline.
///
/// Denoisers learn from clips of a few seconds, most of which show one action. Given "walk forward then sit down", they
/// perform only one half.
///
///     actions_in_turn("walk forward, then sit down");                // {"walk forward", "sit down"}
///     const auto motion = stmc.generate(in_turn(timeline), rng);
#pragma once

#include <string>       // words
#include <string_view>  // sentences
#include <vector>       // actions

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The actions of a sentence, in order. The sentence is cut at "then", "afterwards", "after that", "after which" and
/// "followed by" (with the "and" before them), at semicolons and at full stops. "and" alone joins simultaneous actions.
/// A sentence of one action is returned unchanged.
std::vector<std::string> actions_in_turn(std::string_view sentence);

/// The same, and also cut at commas. If it has a comma, the last "and" after it cuts, too: "walk, turn and wave" has
/// three parts. A part need not be an action: "slowly, on tiptoe".
std::vector<std::string> listed_in_turn(std::string_view sentence);

/// Replaces every text of several actions by one text for each. They follow each other and share its frames evenly.
/// Throws config_error 101 if it has fewer frames than actions.
Timeline in_turn(const Timeline& timeline);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/in_turn.ipp>
#endif
