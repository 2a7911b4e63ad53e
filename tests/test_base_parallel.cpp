#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <vector>

#include "supple/base/parallel.h"

namespace supple {
namespace {

constexpr int kTeams[] = {1, 2, 3, 8};

TEST(BaseParallel, EveryChunkRunsExactlyOnce) {
    for (const int threads : kTeams) {
        with_team(threads, [&](Team& team) {
            EXPECT_GE(team.size(), 1);
            EXPECT_LE(team.size(), threads);
            for (const std::size_t chunks : {std::size_t(0), std::size_t(1), std::size_t(2), std::size_t(7), std::size_t(1000)}) {
                std::vector<int> runs(chunks, 0);
                team.for_chunks(chunks, [&](std::size_t chunk) { ++runs[chunk]; });
                for (const int n : runs) EXPECT_EQ(n, 1);
            }
        });
    }
}

TEST(BaseParallel, RangesCoverEveryIndexOnceInPiecesOfTheGrain) {
    for (const int threads : kTeams) {
        with_team(threads, [&](Team& team) {
            for (const std::size_t n : {std::size_t(0), std::size_t(1), std::size_t(64), std::size_t(65), std::size_t(1000)}) {
                std::vector<int> runs(n, 0);
                team.for_range(n, 64, [&](std::size_t begin, std::size_t end) {
                    EXPECT_EQ(begin % 64, 0u);
                    EXPECT_LE(end - begin, 64u);
                    for (std::size_t i = begin; i < end; ++i) ++runs[i];
                });
                for (const int r : runs) EXPECT_EQ(r, 1);
            }
        });
    }
}

TEST(BaseParallel, LoopsAreOrderedOneAfterTheOther) {
    // Each loop reads what the other ranks wrote in the one before: a missing wait shows as a wrong sum, and in ThreadSanitizer.
    for (const int threads : kTeams) {
        with_team(threads, [&](Team& team) {
            const std::size_t n = 256;
            std::vector<double> a(n, 1), b(n, 0);
            for (int round = 0; round < 200; ++round) {
                team.for_range(n, 16, [&](std::size_t begin, std::size_t end) {
                    for (std::size_t i = begin; i < end; ++i) b[i] = a[n - 1 - i] + 1;
                });
                a.swap(b);
            }
            for (const double x : a) EXPECT_EQ(x, 201);
        });
    }
}

TEST(BaseParallel, LateRanksDoNotDisturbLoopsOfAnotherLength) {
    // More threads than cores: some wake when their loop is long over and a longer one is being handed out.
    std::vector<std::atomic<int>> runs(64);
    for (int region = 0; region < 20; ++region) {
        with_team(6, [&](Team& team) {
            for (int round = 0; round < 2000; ++round) {
                const std::size_t chunks = std::size_t(2 + (round * 7919) % 61);
                for (auto& n : runs) n.store(0, std::memory_order_relaxed);
                team.for_chunks(chunks, [&](std::size_t chunk) { runs[chunk].fetch_add(1, std::memory_order_relaxed); });
                for (std::size_t i = 0; i < runs.size(); ++i) {
                    const int expected = i < chunks ? 1 : 0;
                    if (runs[i].load(std::memory_order_relaxed) != expected) {
                        ADD_FAILURE() << "region " << region << ", round " << round << ": chunk " << i << " of " << chunks << " ran " << runs[i] << " times";
                        return;
                    }
                }
            }
        });
    }
}

TEST(BaseParallel, RanksWorkAtTheSameTime) {
    with_team(2, [&](Team& team) {
        if (team.size() < 2) return;  // the host allows no second thread
        std::atomic<int> arrived{0};
        team.for_chunks(2, [&](std::size_t) {
            arrived.fetch_add(1);
            while (arrived.load() < 2) std::this_thread::yield();  // hangs unless two ranks meet
        });
        EXPECT_EQ(arrived.load(), 2);
    });
}

TEST(BaseParallel, SleepingPartnersWakeUp) {
    // Longer than the spin: the others must be asleep on the futex by then.
    with_team(3, [&](Team& team) {
        for (int round = 0; round < 5; ++round) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            std::atomic<int> runs{0};
            team.for_chunks(30, [&](std::size_t) { runs.fetch_add(1, std::memory_order_relaxed); });
            EXPECT_EQ(runs.load(), 30);
        }
    });
}

TEST(BaseParallel, AnExceptionOfTheBodyComesThroughAndTheNextTeamWorks) {
    for (const int threads : kTeams) {
        EXPECT_THROW(with_team(threads, [](Team& team) {
                         team.for_chunks(4, [](std::size_t) {});
                         throw std::runtime_error("out");
                     }),
                     std::runtime_error);
        std::atomic<int> runs{0};
        with_team(threads, [&](Team& team) { team.for_chunks(9, [&](std::size_t) { ++runs; }); });
        EXPECT_EQ(runs.load(), 9);
    }
}

TEST(BaseParallel, TwoHostThreadsMayEachHaveATeam) {
    std::vector<double> sums(2, 0);
    std::vector<std::thread> hosts;
    for (std::size_t host = 0; host < 2; ++host) {
        hosts.emplace_back([&, host] {
            for (int round = 0; round < 50; ++round) {
                with_team(2, [&](Team& team) {
                    std::vector<double> part(32);
                    team.for_chunks(part.size(), [&](std::size_t i) { part[i] = double(i + host); });
                    for (const double p : part) sums[host] += p;
                });
            }
        });
    }
    for (std::thread& host : hosts) host.join();
    EXPECT_EQ(sums[0], 50 * 496);
    EXPECT_EQ(sums[1], 50 * (496 + 32));
}

TEST(BaseParallel, ATeamInsideALoopOfAnotherStillWorks) {
    std::atomic<int> runs{0};
    with_team(2, [&](Team& outer) {
        outer.for_chunks(2, [&](std::size_t) {
            with_team(2, [&](Team& inner) { inner.for_chunks(5, [&](std::size_t) { ++runs; }); });
        });
    });
    EXPECT_EQ(runs.load(), 10);
}

TEST(BaseParallel, TheMachineHasAThread) { EXPECT_GE(hardware_threads(), 1); }

}  // namespace
}  // namespace supple
