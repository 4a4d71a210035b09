// SPDX-License-Identifier: MIT
/// A model of texts and motions whose vectors are known by hand. It counts how often it is asked, so that a test sees
/// which files were read again.
#pragma once

#include <atomic>
#include <map>
#include <string>
#include <vector>

#include <motionlang/search/search_encoder.hpp>

/// A motion becomes its speed and its turning; "walk N" is a text of the speed N.
class SpeedEncoder final : public motionlang::SearchEncoder {
 public:
  const motionlang::IndexModel& model() const override { return model_; }
  std::vector<float> encode_texts(std::span<const std::string> texts) const override {
    std::vector<float> out;
    for (const std::string& t : texts) {
      const auto speed = static_cast<float>(std::stod(t.substr(t.find(' '))));
      out.insert(out.end(), {speed, 1});
    }
    return out;
  }
  std::vector<float> rows_of(const motionlang::Motion& motion) const override {
    std::vector<float> rows;
    for (motionlang::Index f = 1; f < motion.frames(); ++f)
      rows.push_back(static_cast<float>(motion.fps * motionlang::norm(motion.root_at(f) - motion.root_at(f - 1))));
    ++asked;
    return rows;
  }
  motionlang::Index frames(std::span<const float> rows) const override { return std::ssize(rows); }
  std::vector<float> encode_windows(std::span<const float> rows,
                                    std::span<const motionlang::FrameSlice> windows) const override {
    std::vector<float> out;
    for (const motionlang::FrameSlice& w : windows) {
      float sum = 0;
      for (motionlang::Index f = w.first; f < w.first + w.length; ++f) sum += rows[static_cast<std::size_t>(f)];
      out.insert(out.end(), {sum / static_cast<float>(w.length), 1});
    }
    return out;
  }

  const motionlang::SimilarityScale& similarity() const override { return scale; }
  motionlang::KnownWords known_words() const override { return known; }
  std::vector<std::string> meant(const std::string& query) const override {
    const auto found = meanings.find(query);
    return found == meanings.end() ? std::vector{query} : found->second;
  }

  motionlang::SimilarityScale scale{};
  motionlang::KnownWords known{};
  std::map<std::string, std::vector<std::string>> meanings{};  // of queries that are not themselves what they mean
  mutable std::atomic<int> asked = 0;

 private:
  motionlang::IndexModel model_{.id = "0123456789abcdef", .path = "models/speed", .width = 2, .fps = 20};
};
