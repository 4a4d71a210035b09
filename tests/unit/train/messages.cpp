// Messages between processes: what is written is read, what is cut off is refused, and all get those of all.
#include <doctest/doctest.h>

#include <motionlang/train/messages.hpp>

#include "../../support/check_error.hpp"
#include "../../support/thread_processes.hpp"

namespace ml = motionlang;

TEST_CASE("messages: values, lists and texts in their order") {
  ml::MessageWriter out;
  const std::vector<double> list{1.5, -2};
  out.value(std::int64_t{-7}), out.list(std::span<const double>(list)), out.text("a \"b\"\n"), out.text("");
  out.list(std::span<const float>());
  ml::MessageReader in(out.bytes());
  CHECK(in.value<std::int64_t>() == -7);
  CHECK(in.list<double>() == list);
  CHECK(in.text() == "a \"b\"\n");
  CHECK(in.text().empty());
  CHECK(in.list<float>().empty());
  CHECK(in.at_end());
  CHECK_ERROR(in.value<char>(), "[motionlang.io.402]");
  const std::string cut = out.bytes().substr(0, 20);
  ml::MessageReader of_cut(cut);
  of_cut.value<std::int64_t>();
  CHECK_ERROR(of_cut.list<double>(), "[motionlang.io.402] a message ends inside a list of 2");
}

TEST_CASE("messages: all processes have those of all, in the order of ranks") {
  for (const ml::Index processes : {1, 2, 5}) {
    run_processes(processes, [&](const ThreadProcess& process) {
      const ml::AnyCommunicator all(process);
      const auto messages = ml::messages_of_all(all, std::string(static_cast<std::size_t>(all.rank()), 'x'));
      REQUIRE(std::ssize(messages) == processes);
      for (std::size_t r = 0; r < messages.size(); ++r) CHECK(messages[r] == std::string(r, 'x'));
    });
  }
}
