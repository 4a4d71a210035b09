// Golden functions: labels of BABEL.
#include <motionlang/io/babel.hpp>

#include "golden.hpp"

namespace {

using golden::Case, golden::Registration;
namespace ml = motionlang;

void label_cleaning(Case& c) {
  ml::SpellingTable spelling;
  for (const auto& [word, instead] : c.text()["spelling"].as<std::map<std::string, std::string>>())
    spelling[word] = instead;
  std::string cleaned;
  for (const std::string& label : c.text()["labels"].as<std::vector<std::string>>())
    cleaned += (cleaned.empty() ? "" : "\n") + ml::clean_babel_label(label, spelling);
  c.out_text("labels_utf8", cleaned);
}

const Registration r{"babel label cleaning", "text", label_cleaning};

}  // namespace
