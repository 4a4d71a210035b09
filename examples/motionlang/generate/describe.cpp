// motionlang describe: what motions show, in words. TM2T from motions to texts, of train-tm2t or as its repository
// leaves it.
#include <cstdio>
#include <map>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/generate/motion_describer.hpp>

#include "../commands.hpp"
#include "../files/motion_files.hpp"
#include "../files/weights.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"

namespace program {

namespace {

namespace fs = std::filesystem;
using ml::Index;
using B = ml::EigenBackend<float>;

struct DescribeOptions {
  std::vector<std::string> inputs;
  std::string model, tokenizer, words, out;
  ml::DescribeOptions how;
  bool json = false;
  std::uint64_t seed = 0;
  MotionReadOptions read;
  MachineOptions machine;
};

/// A motion file and what a table of captions calls it.
struct MotionPlace {
  fs::path path;
  std::string clip;
  bool in_folder = false;  // that was named, not the file
};

/// A motion, or a part of a long one, and what is said about it.
struct Described : ml::DescribedPart {
  MotionPlace place;
  std::string name;  // of one motion of several in a file
};

/// Clips that only their extensions tell apart keep these. Throws usage_error 102 if the table, where there is to be
/// one, could not tell clips apart all the same, or if it would take the place of what is read.
std::vector<MotionPlace> places_of(const DescribeOptions& o) {
  std::vector<MotionPlace> out;
  for (const fs::path input : o.inputs) {
    if (!fs::is_directory(input)) {
      out.push_back({input, input.filename().string()});
      continue;
    }
    for (const fs::path& file : motion_files_below(input))
      out.push_back({file, file.lexically_relative(input).generic_string(), true});
  }
  if (out.empty()) ml::raise<ml::config_error>(101, "describe: no motion file in ", o.inputs.front());
  ml::InputFiles inputs{o.read.joints, o.read.asf};
  std::map<std::string, int> named;
  for (const MotionPlace& p : out) {
    inputs.add(p.path);
    ++named[fs::path(p.clip).replace_extension().generic_string()];
  }
  inputs.refuse(o.out);
  std::map<std::string, fs::path> of_clip;
  for (MotionPlace& p : out) {
    const std::string stem = fs::path(p.clip).replace_extension().generic_string();
    if (named[stem] == 1) p.clip = stem;
    const auto [other, is_new] = of_clip.emplace(p.clip, p.path);
    if (!is_new && !o.out.empty())
      ml::raise<usage_error>(102, "--out: ", other->second.string(), " and ", p.path.string(), " would both be '",
                             p.clip, "' in the table");
  }
  return out;
}

class Describer {
 public:
  explicit Describer(const DescribeOptions& options)
      : o_(options),
        places_(places_of(o_)),
        describer_(ml::load_tm2t_describer<B>(ml::find_run(o_.model), {.tokenizer = o_.tokenizer, .words = o_.words})) {
  }

  void run() {
    bool stopped = false;
    {
      ProgressBar bar("describing");
      for (std::size_t i = 0; i < places_.size() && !stopped; ++i) {
        try {
          describe(places_[i], ml::Philox{.seed = o_.seed}.split(static_cast<std::uint64_t>(i)));
        } catch (const ml::error& e) {
          if (places_.size() == 1) throw;
          problems_.push_back(places_[i].path.string() + ": " + e.what());
        }
        stopped = !bar(static_cast<std::ptrdiff_t>(i) + 1, std::ssize(places_)) && i + 1 < places_.size();
      }
    }
    if (!o_.out.empty() && !described_.empty()) write_table();
    for (const std::string& problem : problems_)
      std::fprintf(stderr, "skipped: %s\n", ml::printable(with_options(problem)).c_str());
    if (described_.empty() && !stopped)
      ml::raise<ml::config_error>(101, "describe: none of the ", ml::counted(places_.size(), "file"),
                                  " could be described");
    o_.json ? say_json() : say();
    if (stopped) throw ml::cancelled();  // what was described is kept
  }

 private:
  void describe(const MotionPlace& place, const ml::Philox& rng) {
    const ml::MotionFeatures& features = describer_.features();
    if (kind_of(place.path) == ".npy") {
      if (const auto shape = npy_shape(place.path); shape.size() == 2 && shape[1] == features.width) {
        const auto rows = ml::detail::read_rows(place.path, {features.width}, /*any_number=*/true);
        return add(place, "", describer_.describe_rows(rows, rng, o_.how, place.path.string()));
      }
    }
    ml::MotionReadOptions options = o_.read;
    if (place.in_folder) options = ml::options_for_file(options, place.path);
    const auto motions = read_motions(place.path, options);
    for (std::size_t m = 0; m < motions.size(); ++m)
      add(place, motions.size() > 1 ? motions[m].name : "",
          describer_(motions[m], m == 0 ? rng : rng.split(static_cast<std::uint64_t>(m)), o_.how));
  }
  void add(const MotionPlace& place, const std::string& name, std::vector<ml::DescribedPart> parts) {
    for (ml::DescribedPart& part : parts) described_.push_back({std::move(part), place, name});
  }

  void say() const {
    for (const Described& d : described_) {
      std::printf("%7.2f %7.2f s  %s%s\n", d.start, d.end, ml::printable(d.place.path.string()).c_str(),
                  d.name.empty() ? "" : (" (" + ml::printable(d.name) + ")").c_str());
      for (const ml::Description& text : d.texts)
        std::printf("%9.2f  \"%s\"\n", text.log_probability, ml::printable(text.text).c_str());
    }
    if (!o_.out.empty()) std::printf("table    %s\n", o_.out.c_str());
  }
  void say_json() const {
    auto out = nlohmann::ordered_json::array();
    for (const Described& d : described_) {
      auto texts = nlohmann::ordered_json::array();
      for (const ml::Description& text : d.texts)
        texts.push_back({{"text", text.text}, {"log_probability", text.log_probability}});
      out.push_back({{"path", d.place.path.string()},
                     {"name", d.name},
                     {"start", d.start},
                     {"end", d.end},
                     {"descriptions", std::move(texts)}});
    }
    std::printf("%s\n", out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  }

  /// Of captions, as index and train-* read it; what nothing was said about is left out, and so are files of several
  /// motions, which the table cannot tell apart.
  void write_table() {
    const std::string parts = ml::join_text(ml::body_part_names);
    std::string table = "# clip\tstart\tend\tparts\tcaptions, by " + o_.model + "\n";
    for (const Described& d : described_) {
      std::vector<std::string> said;
      for (const ml::Description& text : d.texts) {
        if (!text.text.empty()) said.push_back(text.text);
      }
      const std::string captions = ml::join_text(said, " | ");
      if (captions.empty() || !d.name.empty()) {
        problems_.push_back(d.place.path.string() +
                            (captions.empty() ? ": no words" : " (" + d.name + "): one of several motions") +
                            ", not in the table");
        continue;
      }
      table += ml::concat_text(d.place.clip, "\t", d.start, "\t", d.end, "\t", parts, "\t", captions, "\n");
    }
    ml::write_file(o_.out, std::string_view(table));
  }

  const DescribeOptions& o_;
  const std::vector<MotionPlace> places_;
  ml::MotionDescriber<B> describer_;
  std::vector<Described> described_;
  std::vector<std::string> problems_;
};

}  // namespace

void add_describe(CLI::App& app) {
  const auto o = std::make_shared<DescribeOptions>();
  CLI::App* c = app.add_subcommand("describe", "Captions motions with a TM2T model from motions to texts");
  c->add_option("input", o->inputs,
                "Motion files (.bvh, .amc, .npz of AMASS, .npy of joints or features, .glb, .vrma) and folders of "
                "them. Motions longer than 196 frames at the model's rate are captioned in parts")
      ->required()
      ->check(CLI::ExistingPath);
  c->add_option("--model", o->model, "Folder of the model: from train-tm2t, or M2T_... as published")
      ->required()
      ->check(CLI::ExistingDirectory);
  c->add_option("--tokenizer", o->tokenizer, "Folder of the motion tokenizer. The default is to look beside the model")
      ->check(CLI::ExistingDirectory);
  c->add_option("--text-encoder", o->words,
                "Folder of the word vectors (our_vab_data.npy). The default is to look in the folders above the model")
      ->check(CLI::ExistingDirectory);
  c->add_option("-o,--out", o->out,
                "Also write a table of captions, which index and the train commands read. Clips are named by their "
                "paths below the given folder")
      ->check(not_empty());
  c->add_option("--top", o->how.top, "Number of captions for each motion, if there are as many different ones")
      ->check(in_range(1, 100))
      ->capture_default_str();
  CLI::Option* beams =
      c->add_option("--beams", o->how.beams,
                    "Beams of the search, at least as many as --top; 1 takes the most probable word at each step")
          ->check(in_range(1, 100))
          ->capture_default_str();
  CLI::Option* sample =
      c->add_flag("--sample", o->how.sample, "Sample words by their probability instead of searching")->excludes(beams);
  c->add_option("--top-k", o->how.top_k, "Sample only from this many of the most probable words")
      ->needs(sample)
      ->check(in_range(1, 1000000))
      ->capture_default_str();
  c->add_option("--seed", o->seed, "Seed of the samples")->needs(sample)->check(seed_number())->capture_default_str();
  c->add_flag("--json", o->json, "Print the result as JSON");
  o->read.add_to(*c);
  o->machine.add_to(*c);
  c->callback([o] {
    if (!o->out.empty()) require_folder_of(o->out);
    o->machine.apply();
    Describer(*o).run();
  });
}

}  // namespace program
