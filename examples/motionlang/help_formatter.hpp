// The format of --help: the same text with every version of CLI11, wrapped, so that OPTIONS.md can be compared with it.
#pragma once

#include <CLI/CLI.hpp>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace program {

/// Descriptions are wrapped at 100 columns. They say in words what an option needs or excludes.
class HelpFormatter : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode) const override {
    const auto positionals = app->get_options([](const CLI::Option* o) { return o->get_positional(); });
    std::string out = wrapped(app->get_description(), 0) + "\nUsage: " + name;
    for (const CLI::Option* o : positionals) out += " " + usage_of(*o);
    out += app->get_require_subcommand_min() > 0 ? " COMMAND [OPTIONS]\n" : " [OPTIONS]\n";
    if (!positionals.empty()) out += "\n" + entries(positionals, true);
    const auto named = [](const CLI::Option* o) { return o->nonpositional(); };
    const auto of_group = [](const CLI::Option* o) { return o->nonpositional() && !o->check_name("--help"); };
    std::string commands;
    for (const CLI::App* sub : app->get_subcommands({})) {
      if (sub->get_name().empty())
        out += "\n" + sub->get_description() + ":\n" + entries(sub->get_options(of_group), false);
      else
        commands += entry(sub->get_name(), sub->get_description());
    }
    out += "\nOptions:\n" + entries(app->get_options(named), false);
    if (!commands.empty()) out += "\nCommands:\n" + commands;
    return app->get_parent() != nullptr || app->get_footer().empty() ? out : out + "\n" + app->get_footer() + "\n";
  }

 private:
  static constexpr std::size_t columns = 100, description_at = 30;

  /// Lines of whole words. All but the first begin with `indent` spaces.
  static std::string wrapped(const std::string& text, std::size_t indent) {
    std::string out;
    std::size_t column = indent;
    for (const std::string& word : CLI::detail::split(text, ' ')) {
      if (column > indent && column + 1 + word.size() > columns) {
        out += "\n" + std::string(indent, ' ');
        column = indent;
      }
      if (column > indent) out += ' ', ++column;
      out += word;
      column += word.size();
    }
    return out + "\n";
  }
  static std::string entry(const std::string& left, const std::string& description) {
    std::string out = "  " + left;
    if (description.empty()) return out + "\n";
    out += out.size() + 2 > description_at ? "\n" + std::string(description_at, ' ')
                                           : std::string(description_at - out.size(), ' ');
    return out + wrapped(description, description_at);
  }
  static std::string entries(const std::vector<const CLI::Option*>& options, bool positional) {
    std::string out;
    for (const CLI::Option* o : options) out += entry(left_of(*o, positional), description_of(*o));
    return out;
  }

  static std::string usage_of(const CLI::Option& o) {
    const std::string name = o.get_name(true) + (o.get_expected_max() > 1 ? "..." : "");
    return o.get_required() ? name : "[" + name + "]";
  }
  /// CLI11 prints such as "FLOAT:0 to 100" or "TEXT:FILE" after a name. This splits it into a word for the value, and
  /// the rest.
  struct Value {
    std::string word, about;
  };
  static Value value_of(const CLI::Option& o) {
    if (o.get_type_size() == 0 || o.get_type_name().empty()) return {};
    std::vector<std::string> said = CLI::detail::split(o.get_type_name(), ':');
    const bool number = said.front() == "FLOAT" || said.front() == "INT" || said.front() == "UINT";
    Value v{number ? "NUMBER" : "TEXT", ""};
    for (std::size_t i = 1; i < said.size(); ++i) {
      if (said[i] == "FILE" || said[i].starts_with("(FILE)"))  // a file or a word of the description
        v.word = "FILE";
      else if (said[i] == "DIR")
        v.word = "FOLDER";
      else if (said[i] == "PATH(existing)")
        v.word = "PATH";
      else if (said[i].starts_with("{"))
        v.about = CLI::detail::find_and_replace(said[i].substr(1, said[i].size() - 2), ",", ", ");
      else
        v.about = said[i];
    }
    if (o.get_expected_max() > 1) v.word += " ...";
    return v;
  }
  static std::string left_of(const CLI::Option& o, bool positional) {
    std::string name = positional ? o.get_name(true) : o.get_name(false, true);
    name = CLI::detail::find_and_replace(CLI::detail::find_and_replace(name, "{false}", ""), ",", ", ");
    const std::string word = positional ? "" : value_of(o).word;
    return word.empty() ? name : name + " " + word;
  }
  static std::string description_of(const CLI::Option& o) {
    std::vector<std::string> more;
    if (o.get_required()) more.push_back("required");
    if (const std::string about = value_of(o).about; !about.empty()) more.push_back(about);
    if (o.get_type_size() != 0 && !o.get_default_str().empty()) more.push_back("default " + o.get_default_str());
    if (!o.get_needs().empty()) more.push_back("needs " + names_of(o.get_needs()));
    if (!o.get_excludes().empty()) more.push_back("not with " + names_of(o.get_excludes()));
    return o.get_description() + (more.empty() ? "" : " (" + CLI::detail::join(more, "; ") + ")");
  }
  /// Alphabetical, because a set of pointers has another order in every run.
  static std::string names_of(const std::set<CLI::Option*>& options) {
    std::vector<std::string> names;
    for (const CLI::Option* o : options) names.push_back(o->get_name());
    std::sort(names.begin(), names.end());
    return CLI::detail::join(names, ", ");
  }
};

}  // namespace program
