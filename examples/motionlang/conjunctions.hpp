// The option --conjunction: how labels of simultaneous actions become a sentence.
#pragma once

#include <map>
#include <string>

#include <CLI/CLI.hpp>

#include <motionlang/text/joined_labels.hpp>

namespace program {

/// Reads the names of conjunctions.
inline CLI::Validator conjunction_names() {
  using motionlang::Conjunction;
  const std::map<std::string, Conjunction> names{{"while", Conjunction::while_},
                                                 {"simultaneously", Conjunction::simultaneously},
                                                 {"comma", Conjunction::comma},
                                                 {"same_time", Conjunction::same_time},
                                                 {"during", Conjunction::during}};
  return CLI::CheckedTransformer(names).description("while, simultaneously, comma, same_time or during");
}

inline constexpr const char* about_tags =
    "SINC: sentences tagged by spaCy, one per line: 'walk while wave#walk/VERB while/SCONJ wave/VERB#0.0#0.0'. They "
    "give "
    "the -ing form after while and during";

}  // namespace program
