#include "stress_options.h"

#include "output_files.h"
#include "supple/base/error.h"

namespace supple::demos {

void StressOptions::add(CLI::App& command) {
    auto* option = command.add_option("--stress", file, "write von Mises and the Cauchy tensor xx yy zz xy yz zx [Pa], one line each");
    command.add_option("--stress-at", at, "vertex or element")->check(CLI::IsMember({"vertex", "element"}))->needs(option);
    command.add_option("--strain", strain, "strain measure: corotational")->check(CLI::IsMember({"corotational", "green"}))->needs(option);
    command.add_option("--recovery", recovery, "vertex stress from element stress: volume-weighted")
        ->check(CLI::IsMember({"raw", "volume-weighted", "spr"}))
        ->needs(option);
}

void StressOptions::check() const {
    if (strain != "corotational")
        throw Error(ErrorCode::unsupported, "--strain " + strain, "this version computes stress from the corotational strain only");
    if (recovery != "volume-weighted")
        throw Error(ErrorCode::unsupported, "--recovery " + recovery,
                    "this version recovers vertex stress by volume-weighted means only; for raw values use --stress-at element");
    require_writable(file);
}

}  // namespace supple::demos
