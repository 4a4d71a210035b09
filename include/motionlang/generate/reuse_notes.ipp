// SPDX-License-Identifier: MIT
// Bodies of reuse_notes.hpp.
#pragma once

#include <cstdio>  // snprintf
#include <vector>  // records

#include <motionlang/core/error.hpp>
#include <motionlang/generate/reuse_notes.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::filesystem::path find_record(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return path;
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.path().filename().string().ends_with(record_extension)) found.push_back(entry.path());
  }
  if (found.size() == 1) return found.front();
  raise<io_error>(401, path.string(), ": ", counted(found.size(), "file"), " *", record_extension,
                  found.empty() ? ", which a run with `record` writes" : "; name one of them");
}

MOTIONLANG_BODY std::string reuse_notes(const StmcReuse& r, std::optional<double> keep_beyond) {
  char text[400];
  const double work = r.whole_work == 0 ? 0 : 100.0 * static_cast<double>(r.work) / static_cast<double>(r.whole_work);
  std::snprintf(text, sizeof text, "%td of %s were reused; %.0f %% of the work of a whole run\n", r.kept,
                counted(r.frames, "frame").c_str(), work);
  std::string out = text;
  if (r.exact) {
    out += "  the motion equals that of a whole run, bit for bit\n";
  } else if (!keep_beyond) {
    out += "  the motion differs from that of a whole run: the reused run was made with `keep_beyond`\n";
  } else {
    std::snprintf(text, sizeof text,
                  "  the motion differs from that of a whole run: frames further than %.2f s from an edit were kept "
                  "(`keep_beyond`)\n",
                  *keep_beyond);
    out += text;
  }
  if (r.everywhere > 0) {
    std::snprintf(
        text, sizeof text,
        "  after step %td of %td nothing could be reused: neighbouring texts share frames, so an edit spreads by one "
        "text per step\n  fewer steps reuse more (fast preset); `keep_beyond` 1 also keeps frames further away, "
        "which the model would change\n",
        r.everywhere, r.steps);
    out += text;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
