#include "gust/study/trials/thread_executor.h"

#include <doctest/doctest.h>

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <new>
#include <thread>

#include "gust/core/error.h"

using namespace gust;

namespace {

using State = Outcome::State;

/// What a test makes of a job.
using Work = std::function<Outcome(std::stop_token, ProgressSink&)>;

/// Jobs, and by their ids what the executor is to do for each.
struct Jobs {
  std::vector<Job> list = {};
  std::map<std::string, Work> work = {};

  void add(const std::string& what, std::vector<std::size_t> needs, Work does) {
    list.push_back({cat(what, "-", list.size()), "train", what, 1, std::move(needs)});
    work[list.back().id] = std::move(does);
  }
  void add(const std::string& what, std::vector<std::size_t> needs, std::function<void()> does) {
    add(what, std::move(needs), Work([does = std::move(does)](std::stop_token, ProgressSink&) {
          does();
          return Outcome{};
        }));
  }
};

std::vector<Outcome> run_all(const Jobs& jobs, std::size_t threads, Progress& progress, std::stop_token stop = {}) {
  ThreadExecutor executor(threads, [&](const Job& job, std::stop_token stopped, ProgressSink& sink) {
    return jobs.work.at(job.id)(std::move(stopped), sink);
  });
  return executor.run(jobs.list, std::move(stop), progress);
}

std::vector<Outcome> run_all(const Jobs& jobs, std::size_t threads) {
  Progress progress(jobs.list);
  return run_all(jobs, threads, progress);
}

std::string states_of(const std::vector<Outcome>& outcomes) {
  std::string text;
  for (const Outcome& outcome : outcomes) text += "dfsx"[static_cast<int>(outcome.state)];  // x: stopped
  return text;
}

}  // namespace

TEST_CASE("jobs on one thread run in plan order, those that wait after what they need") {
  std::string order;
  const auto note = [&](char letter) { return [&order, letter] { order += letter; }; };
  Jobs jobs;
  jobs.add("a", {}, note('a'));
  jobs.add("b", {0}, note('b'));
  jobs.add("c", {}, note('c'));
  jobs.add("d", {1, 2}, note('d'));

  const auto outcomes = run_all(jobs, 1);

  CHECK(order == "abcd");
  CHECK(states_of(outcomes) == "dddd");
}

TEST_CASE("no job begins before what it needs has ended, on any number of threads") {
  constexpr std::size_t kJobs = 400;
  std::vector<std::atomic<bool>> ended(kJobs);
  std::atomic<int> early = 0;
  Jobs jobs;
  for (std::size_t i = 0; i < kJobs; ++i) {
    std::vector<std::size_t> needs;
    if (i >= 3) needs = {i / 2, i - 3};
    jobs.add("job", needs, [&ended, &early, needs, i] {
      for (const std::size_t need : needs) early += ended[need] ? 0 : 1;
      ended[i] = true;
    });
  }

  const auto outcomes = run_all(jobs, 8);

  CHECK(early == 0);
  CHECK(states_of(outcomes) == std::string(kJobs, 'd'));
}

TEST_CASE("jobs run side by side") {
  std::mutex mutex;
  std::condition_variable met;
  int here = 0;
  const auto meet = [&] {
    std::unique_lock lock(mutex);
    ++here;
    met.notify_all();
    if (!met.wait_for(lock, std::chrono::seconds(30), [&] { return here == 3; })) throw Error("nobody came");
  };
  Jobs jobs;
  for (const char* name : {"a", "b", "c"}) jobs.add(name, {}, meet);

  CHECK(states_of(run_all(jobs, 3)) == "ddd");
}

TEST_CASE("a failure has its reason, takes along what needs it, and nothing else") {
  const auto fine = [] {};
  Jobs jobs;
  jobs.add("a", {}, [] { throw Error("a: no space"); });
  jobs.add("b", {}, [] { throw std::bad_alloc(); });
  jobs.add("c", {}, [] { throw Bug("c.cpp:1: expected x"); });
  jobs.add("d", {0}, fine);
  jobs.add("e", {3, 1}, fine);
  jobs.add("f", {}, fine);
  jobs.add("g", {5}, fine);

  for (const std::size_t threads : {1, 4}) {
    const auto outcomes = run_all(jobs, threads);

    CHECK(states_of(outcomes) == "fffssdd");
    CHECK(outcomes[0].reason == "a: no space");
    CHECK(outcomes[1].reason == "out of memory");
    CHECK(outcomes[2].reason == "internal error: c.cpp:1: expected x");
    CHECK(outcomes[3].reason == "input missing: a");
    CHECK(outcomes[5].reason == "");
  }
}

TEST_CASE("a stop reaches the running jobs and begins no others") {
  std::stop_source source;
  Jobs jobs;
  jobs.add("before", {}, [] {});
  jobs.add("running", {}, Work([&](std::stop_token stop, ProgressSink&) {
             source.request_stop();
             while (!stop.stop_requested()) std::this_thread::yield();
             return Outcome{State::stopped, ""};
           }));
  jobs.add("after", {}, [] {});
  jobs.add("needs running", {1}, [] {});
  Progress progress(jobs.list);

  const auto outcomes = run_all(jobs, 1, progress, source.get_token());

  CHECK(states_of(outcomes) == "dxxx");
  CHECK(progress.now().finished == 1);
}

TEST_CASE("a stop from outside ends threads that wait for work") {
  std::stop_source source;
  Jobs jobs;
  jobs.add("long", {}, Work([](std::stop_token stop, ProgressSink&) {
             while (!stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
             return Outcome{State::stopped, ""};
           }));
  jobs.add("waits", {0}, [] {});
  Progress progress(jobs.list);
  std::jthread stopper([&] {
    while (progress.now().running.empty()) std::this_thread::yield();
    source.request_stop();
  });

  CHECK(states_of(run_all(jobs, 4, progress, source.get_token())) == "xx");
}

TEST_CASE("a job that stops by itself holds up nobody") {
  Jobs jobs;
  jobs.add("quits", {}, Work([](std::stop_token, ProgressSink&) { return Outcome{State::stopped, ""}; }));
  jobs.add("needs it", {0}, [] {});
  jobs.add("does not", {}, [] {});

  Progress progress(jobs.list);
  CHECK(states_of(run_all(jobs, 2, progress)) == "xxd");
  CHECK(progress.now().finished == 1);
}

TEST_CASE("progress weighs jobs by their predicted time and names those that run") {
  std::vector<Job> jobs(3);
  for (std::size_t i = 0; i < jobs.size(); ++i)
    jobs[i] = {cat("id-", i), "evaluate", cat("job ", i), i == 0 ? 6.0 : 2.0, {}};
  Progress progress(jobs);

  progress.start(1);
  progress.advance(1, 0.5);
  progress.start(0);
  progress.finish(0);

  const Progress::Moment moment = progress.now();
  CHECK(moment.fraction == doctest::Approx(0.7).epsilon(1e-12));
  CHECK(moment.finished == 1);
  CHECK(moment.jobs == 3);
  CHECK(moment.running == std::vector<std::string>{"job 1"});
}

TEST_CASE("no jobs are done at once") { CHECK(run_all({}, 4).empty()); }

TEST_CASE("a job that needs a later one is our mistake") {
  Jobs jobs;
  jobs.add("a", {1}, [] {});
  jobs.add("b", {}, [] {});

  CHECK_THROWS_AS(run_all(jobs, 1), Bug);
}
