// motionlang index: a folder of motions becomes a file in which `motionlang search` finds them by words.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <optional>
#include <set>

#include <motionlang/core/text_lines.hpp>
#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/search/motion_search.hpp>
#include <motionlang/search/vector_graph.hpp>

#include "../commands.hpp"
#include "../files/motion_files.hpp"
#include "../files/weights.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "../train/clip_lines.hpp"
#include "search_model.hpp"

namespace program {

namespace {

namespace fs = std::filesystem;
using ml::Index;

struct IndexOptions {
  std::string folder, model, out, text_encoder, captions, license;
  std::vector<std::string> remove;
  std::vector<double> windows{1, 2, 3};  // seconds
  double stride = 0.5;
  bool windows_given = false;  // or the stride
  bool no_moments = false, again = false, list = false;
  MotionReadOptions read;
  MachineOptions machine;
  Index graph = 100'000;
};

/// A file as the file system has it.
struct FileState {
  fs::path path;
  std::int64_t modified = 0, bytes = 0;
};

std::vector<FileState> file_states(const fs::path& folder) {
  std::vector<FileState> files;
  for (const fs::path& path : motion_files_below(folder)) {
    const auto time =
        std::chrono::duration_cast<std::chrono::nanoseconds>(fs::last_write_time(path).time_since_epoch());
    files.push_back({path.lexically_normal(), time.count(), static_cast<std::int64_t>(fs::file_size(path))});
  }
  return files;
}

fs::path folder_of(const fs::path& path) {
  const fs::path whole = fs::weakly_canonical(path);
  return whole.has_filename() ? whole : whole.parent_path();
}
std::string checksum(std::span<const std::byte> bytes) {
  return ml::detail::hexadecimal(ml::detail::content_hash(bytes));
}
std::string checksum(const fs::path& file) { return checksum(ml::MappedFile::open(file.string())->bytes()); }
std::string checksum(const std::vector<ClipLine>& lines) {
  std::string all;
  for (const ClipLine& line : lines) {
    all += ml::concat_text(line.start, "\t", line.end);
    for (const std::string& text : line.texts) all += "\t" + text;
    all += "\n";
  }
  return checksum(std::as_bytes(std::span(all)));
}
bool is_below(const fs::path& path, const fs::path& folder) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end();
}

/// The first line of the file LICENSE (LICENCE, COPYING, with or without an extension) beside a motion or in a folder
/// above it, as UTF-8.
class LicenseFiles {
 public:
  explicit LicenseFiles(fs::path top) : top_(std::move(top)) {}
  const std::string& of(const fs::path& folder) {
    const auto [entry, is_new] = known_.try_emplace(folder);
    if (!is_new) return entry->second;
    std::string text = beside(folder);
    if (text.empty() && folder != top_ && is_below(folder, top_)) text = of(folder.parent_path());
    return known_[folder] = std::move(text);
  }

 private:
  static std::string beside(const fs::path& folder) {
    std::set<fs::path> found;
    for (const auto& entry : fs::directory_iterator(folder)) {
      std::string name = entry.path().stem().string();
      for (char& c : name) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
      std::error_code none;
      if (entry.is_regular_file(none) && (name == "LICENSE" || name == "LICENCE" || name == "COPYING"))
        found.insert(entry.path());
    }
    if (found.empty()) return {};
    std::string first;
    ml::detail::for_each_line(ml::read_file(*found.begin()), [&](std::string_view line, Index) {
      line.remove_prefix(std::min(line.find_first_not_of(" \t#"), line.size()));
      if (first.empty()) first = ml::printable(ml::utf8_head(line, 200));
    });
    return first;
  }

  fs::path top_;
  std::map<fs::path, std::string> known_;
};

class Indexer {
 public:
  explicit Indexer(const IndexOptions& options) : o_(options) {
    if (!fs::exists(o_.out)) return;
    before_ = ml::MotionIndexFile::open(o_.out);
    index_ = before_->index();
  }

  void run() {
    if (o_.folder.empty() && !o_.list && o_.remove.empty())
      ml::raise<usage_error>(102, "index: a folder of motions is missing (or --list, or --remove)");
    if (!index_ && (o_.folder.empty() || !o_.remove.empty()))
      ml::raise<ml::io_error>(401, "index: there is no ", o_.out, " yet");
    require_folder_of(o_.out);
    remove();
    if (!o_.folder.empty()) update();
    if (o_.list) list();
  }

 private:
  // ---- removing and listing

  void remove() {
    if (o_.remove.empty()) return;
    Index removed = 0;
    for (const std::string& path : o_.remove) {
      const fs::path whole = folder_of(path);
      const Index now = index_->remove_if([&](const ml::IndexedClip& c) { return is_below(c.path, whole); });
      if (now == 0) std::fprintf(stderr, "%s is not in the index\n", ml::printable(path).c_str());
      removed += now;
    }
    if (removed == 0 && o_.folder.empty() && !o_.list)
      ml::raise<usage_error>(103, "--remove: ", o_.out, " has no clip of these");
    if (removed == 0) return;
    const bool stopped = write(false);
    std::printf("%s: %s removed, %td left\n", o_.out.c_str(), ml::counted(removed, "clip").c_str(), index_->count());
    if (stopped) throw ml::cancelled();
  }
  void list() const {
    for (const ml::IndexedClip& c : index_->clips()) {
      const std::string path = c.path + (c.name.empty() ? "" : "#" + c.name);
      std::string captions;
      for (const std::string& text : c.captions) captions += (captions.empty() ? "" : " | ") + text;
      std::printf("%s\t%.2f\t%.2f\t%g\t%td\t%s\t%s\n", ml::printable(path).c_str(), c.start, c.end, c.fps, c.frames,
                  ml::printable(captions).c_str(), ml::printable(c.license).c_str());
    }
  }

  // ---- adding

  void update() {
    const fs::path folder = folder_of(o_.folder);
    std::vector<ClipLine> table;
    if (!o_.captions.empty()) table = read_captions(o_.captions, folder);
    open_model();
    take_table(std::move(table), folder);
    LicenseFiles licenses(folder);
    licenses_ = &licenses;
    const auto files = file_states(folder);
    if (files.empty())
      std::fprintf(stderr, "no .bvh, .amc, .npz, .npy, .glb or .vrma file below %s\n", folder.string().c_str());
    const auto fresh = changed_files(files, folder);
    bool stopped = false;
    {
      ProgressBar bar("indexing");
      // A few files at a time: reading is split over threads here, encoding inside the model.
      const auto at_once = static_cast<std::size_t>(8 * ml::thread_count());
      for (std::size_t begin = 0; begin < fresh.size() && !stopped; begin += at_once) {
        const auto some = std::span(fresh).subspan(begin, std::min(at_once, fresh.size() - begin));
        add(some);
        stopped = !bar(static_cast<std::ptrdiff_t>(begin + some.size()), std::ssize(fresh));
      }
    }
    if (added_ + removed_ + renamed_ + relicensed_ > 0 || model_moved_ || !before_ || lacks_graphs())
      stopped = write(stopped);
    for (const std::string& problem : problems_) std::fprintf(stderr, "skipped: %s\n", ml::printable(problem).c_str());
    std::printf("%s: %s, %s (%td added, %td removed, %td renamed, %td unchanged, %zu skipped)\n", o_.out.c_str(),
                ml::counted(index_->count(), "clip").c_str(), ml::counted(index_->moments().size(), "moment").c_str(),
                added_, removed_, renamed_, unchanged_, problems_.size());
    if (relicensed_ > 0)
      std::printf("%s another license now\n", ml::counted(relicensed_, "file has", "files have").c_str());
    if (stopped) throw ml::cancelled();  // what was encoded is kept
    for (const FileState& f : files) lines_of_.erase(f.path.string());
    for (const auto& [clip, lines] : lines_of_)
      std::fprintf(stderr, "%s: there is no clip '%s' below %s\n", o_.captions.c_str(), ml::printable(clip).c_str(),
                   folder.string().c_str());
  }

  void open_model() {
    const std::string path = !o_.model.empty() ? o_.model
                             : index_          ? index_->model().path
                                               : default_search_model().string();
    const std::string encoder = !o_.text_encoder.empty() ? o_.text_encoder : index_ ? index_->model().text_encoder : "";
    model_.emplace(folder_of(model_folder(path)), encoder.empty() ? fs::path() : folder_of(encoder));
    ml::IndexModel wanted{.id = model_->id(),
                          .path = model_->folder().string(),
                          .text_encoder = model_->text_encoder().string(),
                          .width = model_->width(),
                          .fps = model_->fps()};
    if (!o_.no_moments) {
      for (const double seconds : o_.windows)
        wanted.windows.push_back(std::max<Index>(1, std::lround(seconds * wanted.fps)));
      wanted.stride = std::max<Index>(1, std::lround(o_.stride * wanted.fps));
    }
    if (!index_) {
      index_.emplace(std::move(wanted));
      return;
    }
    index_->require_model(model_->id(), path);
    const ml::IndexModel& is = index_->model();
    if ((o_.windows_given || o_.no_moments) && (is.windows != wanted.windows || is.stride != wanted.stride))
      ml::raise<usage_error>(102, "index: ", o_.out, " has moments of ", is.windows.size(),
                             " other lengths or another stride; they are chosen when an index is made");
    model_moved_ = is.path != wanted.path || is.text_encoder != wanted.text_encoder;
    index_->move_model(wanted.path, wanted.text_encoder);
  }

  void take_table(std::vector<ClipLine> table, const fs::path& folder) {
    if (table.empty()) return;
    std::set<std::string> distinct;
    for (ClipLine& line : table) {
      distinct.insert(line.texts.begin(), line.texts.end());
      const fs::path path = line.file.empty() ? (folder / line.clip).lexically_normal() : line.file;
      lines_of_[path.string()].push_back(std::move(line));
    }
    const std::vector<std::string> texts(distinct.begin(), distinct.end());
    const auto vectors = model_->texts(texts);
    const auto width = static_cast<std::size_t>(model_->width());
    for (std::size_t i = 0; i < texts.size(); ++i) {
      const auto row = std::span(vectors).subspan(i * width, width);
      vector_of_[texts[i]].assign(row.begin(), row.end());
    }
  }

  /// Forgets what is gone, renames what has only moved, and says what is to be read: new and changed files, and those
  /// of which the table says something new.
  std::vector<FileState> changed_files(const std::vector<FileState>& files, const fs::path& folder) {
    std::map<std::string, ml::IndexedClip> known;  // a clip of each file
    std::set<std::string> now;
    for (const ml::IndexedClip& c : index_->clips()) known.emplace(c.path, c);
    for (const FileState& f : files) now.insert(f.path.string());
    std::map<std::pair<std::int64_t, std::string>, ml::IndexedClip> moved;  // gone from where they were: time, content
    for (const auto& [path, c] : known) {
      if (!c.content.empty() && is_below(path, folder) && !now.contains(path)) moved[{c.modified, c.content}] = c;
    }
    std::set<std::string> outdated;
    std::vector<FileState> fresh;
    for (const FileState& f : files) {
      const std::string path = f.path.string();
      const auto before = known.find(path);
      auto from = moved.end();
      if (!o_.again && before == known.end() && !moved.empty()) {
        try {
          from = moved.find({f.modified, checksum(f.path)});
        } catch (const ml::io_error&) {  // said when it is read
        }
      }
      if (!o_.again && before != known.end() && before->second.modified == f.modified &&
          before->second.bytes == f.bytes && has_lines(before->second, path)) {
        ++unchanged_;
        keep(before->second, path);
      } else if (from != moved.end() && has_lines(from->second, path)) {
        index_->rename(from->second.path, path);
        ++renamed_;
        keep(from->second, path);
        moved.erase(from);
      } else {
        if (before != known.end()) {
          outdated.insert(path);
          if (!o_.again && before->second.modified == f.modified) license_before_[path] = before->second.license;
        }
        fresh.push_back(f);
      }
    }
    removed_ = index_->remove_if([&](const ml::IndexedClip& c) {
      return outdated.contains(c.path) || (is_below(c.path, folder) && !now.contains(c.path));
    });
    return fresh;
  }
  /// Whether the clips of a file are what the table says; a file that it does not name stays as it is.
  bool has_lines(const ml::IndexedClip& c, const std::string& path) const {
    const auto found = lines_of_.find(path);
    return found == lines_of_.end() || c.lines == checksum(found->second);
  }
  /// A file that is not read again.
  void keep(const ml::IndexedClip& c, const std::string& path) {
    const std::string license = license_of(path, c.license);
    if (license == c.license) return;
    index_->set_license(path, license);
    ++relicensed_;
  }
  /// That of this call, else of the LICENSE file, else what the index had.
  std::string license_of(const fs::path& path, const std::string& before) const {
    if (!o_.license.empty()) return ml::printable(o_.license);
    const std::string& beside = licenses_->of(path.parent_path());
    return beside.empty() ? before : beside;
  }

  /// A clip on its way into the index, or why it does not get there.
  struct Prepared {
    ml::IndexedClip clip;
    std::vector<float> rows;
    std::string problem;
  };

  void add(std::span<const FileState> files) {
    std::vector<std::vector<Prepared>> prepared(files.size());
    ml::parallel_for(std::ssize(files), [&](Index i) {
      const auto f = static_cast<std::size_t>(i);
      try {
        prepared[f] = prepare(files[f]);
      } catch (const ml::error& e) {
        prepared[f] = {{{.path = files[f].path.string()}, {}, e.what()}};
      }
    });
    for (std::size_t f = 0; f < files.size(); ++f) {
      for (Prepared& p : prepared[f]) {
        const auto before = license_before_.find(files[f].path.string());
        p.clip.license = license_of(files[f].path, before != license_before_.end() ? before->second : "");
        encode(std::move(p));
      }
    }
  }
  /// Of a file the whole motions, or the parts of its motion that the table of captions names.
  std::vector<Prepared> prepare(const FileState& file) const {
    std::vector<Prepared> out;
    if (!ml::is_utf8(file.path.string()))
      ml::raise<ml::io_error>(404, "the path is not UTF-8, as which an index keeps it");
    const auto motions = read_motions(file.path, options_in_folder(o_.read, file.path));
    const auto found = lines_of_.find(file.path.string());
    const std::string content = checksum(file.path), lines = found != lines_of_.end() ? checksum(found->second) : "";
    const auto take = [&](const ml::Motion& m, const ClipLine* line) {
      Prepared& p = out.emplace_back();
      p.clip.path = file.path.string(), p.clip.modified = file.modified, p.clip.bytes = file.bytes;
      p.clip.content = content, p.clip.lines = lines;
      if (motions.size() > 1) p.clip.name = m.name;
      if (line != nullptr) p.clip.start = line->start, p.clip.captions = line->texts;
      try {
        const ml::Motion part = line != nullptr ? segment_of(m, *line, 2) : m;
        part.validate();
        p.clip.end = p.clip.start + part.seconds(), p.clip.fps = part.fps, p.clip.frames = part.frames();
        p.rows = model_->rows(part);
      } catch (const ml::error& e) {
        p.problem = e.what();
      }
    };
    for (const ml::Motion& m : motions) {
      if (found == lines_of_.end())
        take(m, nullptr);
      else
        for (const ClipLine& line : found->second) take(m, &line);
    }
    return out;
  }
  void encode(Prepared p) {
    const std::string name = p.clip.path + (p.clip.name.empty() ? "" : "#" + p.clip.name);
    try {
      if (p.problem.empty()) {
        ml::EncodedClip c{.clip = std::move(p.clip), .vector = model_->clip(p.rows)};
        c.moments = ml::indexed_moments(model_->frames(p.rows), index_->model());
        c.moment_vectors = model_->windows(p.rows, c.moments);
        for (const std::string& text : c.clip.captions) {
          const auto& v = vector_of_.at(text);
          c.caption_vectors.insert(c.caption_vectors.end(), v.begin(), v.end());
        }
        index_->add(std::move(c));
        ++added_;
      }
    } catch (const ml::numeric_error& e) {  // vectors of length 0
      p.problem = e.what();
    }
    if (!p.problem.empty()) problems_.push_back(name + ": " + p.problem);
  }

  bool lacks_graphs() const { return MOTIONLANG_HAS_HNSWLIB && !ml::has_graphs(*before_, o_.graph); }
  /// Returns whether Ctrl-C stopped it. Then the index has no graphs: searches compare all until the next update.
  bool write(bool stopped) const {
    ml::IndexExtras graphs;
    if (!MOTIONLANG_HAS_HNSWLIB && !ml::detail::graph_rows(*index_, o_.graph).empty())
      std::fprintf(stderr, "no graph: this program was built without hnswlib (libhnswlib-dev); searches compare all\n");
    try {
      ProgressBar bar("connecting");
      if (!stopped) graphs = ml::motion_graphs(*index_, o_.graph, bar, before_ ? &*before_ : nullptr);
    } catch (const ml::cancelled&) {
      stopped = true;
    }
    ml::write_motion_index(o_.out, *index_, graphs);
    return stopped;
  }

  const IndexOptions& o_;
  std::optional<ml::MotionIndexFile> before_;
  std::optional<ml::MotionIndex> index_;
  std::optional<SearchModel> model_;
  bool model_moved_ = false;
  LicenseFiles* licenses_ = nullptr;
  std::map<std::string, std::vector<ClipLine>> lines_of_;  // by the path of their file
  std::map<std::string, std::vector<float>> vector_of_;    // of captions
  std::map<std::string, std::string> license_before_;      // of files that are read again for their captions
  std::vector<std::string> problems_;
  Index added_ = 0, removed_ = 0, renamed_ = 0, unchanged_ = 0, relicensed_ = 0;
};

}  // namespace

void add_index(CLI::App& app) {
  const auto o = std::make_shared<IndexOptions>();
  CLI::App* c =
      app.add_subcommand("index", "Makes or updates a file in which `motionlang search` finds motions by words");
  c->add_option(
       "folder", o->folder,
       "Folder with .bvh, .amc, .npz (AMASS), .npy (joints or features), .glb and .vrma files, searched to the "
       "bottom; files that have not changed are not read again")
      ->check(CLI::ExistingDirectory);
  c->add_option("-o,--out", o->out, "The index")->required();
  c->add_option("--model", o->model,
                "Folder of TMR: of train-tmr or as it was published; that of the index unless given, of a new one the "
                "model that comes with motionlang")
      ->check(CLI::ExistingDirectory);
  c->add_option("--text-encoder", o->text_encoder,
                "Language model that the model reads, if it has no word pieces of its own: a folder, or a cache (.npy)")
      ->check(CLI::ExistingPath);
  c->add_option("--captions", o->captions, "Table of parts of clips and what they show (examples/training/README.md)")
      ->check(CLI::ExistingFile);
  c->add_option("--license", o->license,
                "Of the motions below the folder, those that are in the index as well; unless given, the first line of "
                "the LICENSE "
                "file beside or above them as it is now; without such a file, what the index had");
  const CLI::Option* windows = c->add_option("--windows", o->windows, "Lengths of moments, seconds")
                                   ->delimiter(',')
                                   ->check(in_range(0.05, 600))
                                   ->capture_default_str();
  const CLI::Option* stride = c->add_option("--stride", o->stride, "From one moment to the next, seconds")
                                  ->check(in_range(0.05, 600))
                                  ->capture_default_str();
  c->add_flag("--no-moments", o->no_moments, "Only whole clips: a smaller index, sooner made");
  c->add_flag("--again", o->again, "Reads all files, changed or not");
  c->add_option("--remove", o->remove, "Files or folders whose clips are taken out of the index");
  c->add_flag("--list", o->list, "Lists the clips: path, start, end, frames per second, frames, captions, license");
  o->read.add_to(*c);
  c->add_option("--graph", o->graph,
                "From so many clips or moments on, searches follow a graph that finds most of the nearest, instead of "
                "comparing all; additions are put into it, after removals it is made anew")
      ->check(positive())
      ->capture_default_str();
  o->machine.add_to(*c);
  c->callback([=] {
    o->windows_given = windows->count() + stride->count() > 0;
    o->machine.apply();
    Indexer(*o).run();
  });
}

}  // namespace program
