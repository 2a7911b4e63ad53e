#pragma once
#include <string>

namespace supple::demos {

/// The machine under a measurement: its name, and how fast it reads memory right now, neighbours included.
struct Machine {
    std::string processor;      ///< "AMD EPYC 9B45", "unknown processor"
    int cores = 1;
    double read_one_gb_s = 0;   ///< 256 MB read by one thread
    double read_all_gb_s = 0;   ///< by one thread per core
    double cache_one_gb_s = 0;  ///< 10 MB, again and again: what bodies of some ten thousand elements live in
    double cache_all_gb_s = 0;
    std::string line() const;
};

Machine measure_machine();

}  // namespace supple::demos
