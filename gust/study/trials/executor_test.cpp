#include "gust/study/trials/executor.h"

#include <doctest/doctest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <thread>

#include "gust/core/error.h"

using namespace gust;

namespace {

using State = Outcome::State;

Job job_of(std::string name, std::vector<std::size_t> needs, std::function<void()> work) {
  return {std::move(name), 1, std::move(needs), [work = std::move(work)](std::stop_token, ProgressSink&) {
            work();
            return Outcome{};
          }};
}

std::vector<Outcome> run_all(const std::vector<Job>& jobs, std::size_t threads) {
  Progress progress(jobs);
  return run_jobs(jobs, threads, {}, progress);
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
  const std::vector<Job> jobs = {job_of("a", {}, note('a')), job_of("b", {0}, note('b')), job_of("c", {}, note('c')),
                                 job_of("d", {1, 2}, note('d'))};

  const auto outcomes = run_all(jobs, 1);

  CHECK(order == "abcd");
  CHECK(states_of(outcomes) == "dddd");
}

TEST_CASE("no job begins before what it needs has ended, on any number of threads") {
  constexpr std::size_t kJobs = 400;
  std::vector<std::atomic<bool>> ended(kJobs);
  std::atomic<int> early = 0;
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < kJobs; ++i) {
    std::vector<std::size_t> needs;
    if (i >= 3) needs = {i / 2, i - 3};
    jobs.push_back(job_of("job", needs, [&ended, &early, needs, i] {
      for (const std::size_t need : needs) early += ended[need] ? 0 : 1;
      ended[i] = true;
    }));
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
  const std::vector<Job> jobs = {job_of("a", {}, meet), job_of("b", {}, meet), job_of("c", {}, meet)};

  CHECK(states_of(run_all(jobs, 3)) == "ddd");
}

TEST_CASE("a failure has its reason, takes along what needs it, and nothing else") {
  const auto fine = [] {};
  const std::vector<Job> jobs = {job_of("a", {}, [] { throw Error("a: no space"); }),
                                 job_of("b", {}, [] { throw std::bad_alloc(); }),
                                 job_of("c", {}, [] { throw Bug("c.cpp:1: expected x"); }),
                                 job_of("d", {0}, fine),
                                 job_of("e", {3, 1}, fine),
                                 job_of("f", {}, fine),
                                 job_of("g", {5}, fine)};

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
  std::vector<Job> jobs = {job_of("before", {}, [] {})};
  jobs.push_back({"running", 1, {}, [&](std::stop_token stop, ProgressSink&) {
                    source.request_stop();
                    while (!stop.stop_requested()) std::this_thread::yield();
                    return Outcome{State::stopped, ""};
                  }});
  jobs.push_back(job_of("after", {}, [] {}));
  jobs.push_back(job_of("needs running", {1}, [] {}));
  Progress progress(jobs);
  std::size_t told = 0;

  const auto outcomes = run_jobs(jobs, 1, source.get_token(), progress, [&](std::size_t, const Outcome&) { ++told; });

  CHECK(states_of(outcomes) == "dxxx");
  CHECK(told >= 2);
}

TEST_CASE("a stop from outside ends threads that wait for work") {
  std::stop_source source;
  std::vector<Job> jobs;
  jobs.push_back({"long", 1, {}, [](std::stop_token stop, ProgressSink&) {
                    while (!stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                    return Outcome{State::stopped, ""};
                  }});
  jobs.push_back(job_of("waits", {0}, [] {}));
  Progress progress(jobs);
  std::jthread stopper([&] {
    while (progress.now().running.empty()) std::this_thread::yield();
    source.request_stop();
  });

  CHECK(states_of(run_jobs(jobs, 4, source.get_token(), progress)) == "xx");
}

TEST_CASE("a job that stops by itself holds up nobody") {
  std::vector<Job> jobs;
  jobs.push_back({"quits", 1, {}, [](std::stop_token, ProgressSink&) { return Outcome{State::stopped, ""}; }});
  jobs.push_back(job_of("needs it", {0}, [] {}));
  jobs.push_back(job_of("does not", {}, [] {}));

  Progress progress(jobs);
  CHECK(states_of(run_jobs(jobs, 2, {}, progress)) == "xxd");
  CHECK(progress.now().finished == 1);
}

TEST_CASE("progress weighs jobs by their predicted time and names those that run") {
  std::vector<Job> jobs(3);
  for (std::size_t i = 0; i < jobs.size(); ++i) jobs[i] = {cat("job ", i), i == 0 ? 6.0 : 2.0, {}, {}};
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
  const std::vector<Job> jobs = {job_of("a", {1}, [] {}), job_of("b", {}, [] {})};

  CHECK_THROWS_AS(run_all(jobs, 1), Bug);
}
