// Requests to the studio's server: any head is decided, and only the whole token passes; any body is a question within
// the limits or refused.
#include <cstdint>
#include <string_view>

#include <motionlang/generate/studio_request.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

/// Lines of the input: method, path, host, origin, site, type, token. What follows them is the body.
std::string_view line_of(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  const std::string_view out = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return out;
}

void check_head(std::string_view& rest) {
  static const ml::StudioGate gate{.hosts = ml::loopback_hosts(8421), .token = "f00d"};
  ml::StudioHead head;
  for (std::string ml::StudioHead::*field :
       {&ml::StudioHead::method, &ml::StudioHead::path, &ml::StudioHead::host, &ml::StudioHead::origin,
        &ml::StudioHead::site, &ml::StudioHead::type, &ml::StudioHead::token})
    head.*field = line_of(rest);
  const ml::StudioRefusal no = ml::refusal(gate, head);
  check(no.status == 0 || (no.status >= 400 && no.status < 500 && !no.reason.empty()), "a refusal has a status");
  if (no.status != 0) return;
  check(head.path == "/" || (head.path == "/ask" && head.token == gate.token && head.method == "POST"),
        "only a token gets an answer");
  check(head.origin.empty() || head.origin.size() == head.host.size() + 7, "only the own origin gets an answer");
}

void check_question(std::string_view body) {
  const ml::StudioLimits limits{.question = 3000, .file = 500, .text = 200};
  refusing([&] {
    const ml::StudioQuestion q = ml::parse_studio_question(body, limits);
    check(q.client.size() == 32, "a client has 32 digits");
    check(q.timeline.size() <= limits.text && q.id.size() <= limits.text, "texts have a limit");
    check(q.bytes.size() <= limits.file + 3, "files have a limit");
    check(q.name.empty() || ml::is_studio_file(q.name), "names are plain");
    check(q.count >= 0 && q.count <= limits.offered && q.beyond >= 0 && q.beyond <= limits.seconds,
          "numbers have limits");
    check(!q.clip || (q.clip->start <= q.clip->end && q.clip->end <= limits.seconds), "a clip has an order");
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  if (size > 0 && data[0] == '{') return check_question(rest), 0;
  check_head(rest);
  check_question(rest);
  return 0;
}
