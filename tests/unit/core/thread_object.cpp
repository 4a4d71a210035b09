// Objects of which every thread has its own.
#include <doctest/doctest.h>

#include <thread>

#include <motionlang/core/thread_object.hpp>

namespace ml = motionlang;

namespace {

struct Counted {
  inline static int made = 0, gone = 0;  // the threads of the test run one after the other
  int value = 0;
  Counted() { ++made; }
  ~Counted() { ++gone; }
};
struct Other;

}  // namespace

TEST_CASE("every thread has its own object, as long as it runs") {
  ml::thread_object<Counted>().value = 1;
  CHECK(ml::thread_object<Counted>().value == 1);
  CHECK(ml::thread_object<Counted, Other>().value == 0);
  CHECK(Counted::made == 2);
  std::thread([] {
    CHECK(ml::thread_object<Counted>().value == 0);
    CHECK(Counted::made == 3);
    CHECK(Counted::gone == 0);
  }).join();
  CHECK(Counted::gone == 1);
  CHECK(ml::thread_object<Counted>().value == 1);
}
