#include "stress_options.h"

#include "output_files.h"

namespace supple::demos {

void StressOptions::add(CLI::App& command) {
    auto* option = command.add_option("--stress", file, "write von Mises and the Cauchy tensor xx yy zz xy yz zx [Pa], one line each");
    command.add_option("--stress-at", at, "vertex or element")->check(CLI::IsMember({"vertex", "element"}))->needs(option);
    command.add_option("--strain", strain, "strain measure of linear and corotational laws: corotational or green")
        ->check(CLI::IsMember({"corotational", "green"}))
        ->needs(option);
    command.add_option("--recovery", recovery, "vertex stress from element stress: raw, volume-weighted or spr")
        ->check(CLI::IsMember({"raw", "volume-weighted", "spr"}))
        ->needs(option);
}

void StressOptions::check() const { require_writable(file); }

StressDef StressOptions::def() const {
    StressDef def;
    def.at = at == "element" ? StressAt::element : StressAt::vertex;
    def.strain = strain == "green" ? StrainMeasure::green : StrainMeasure::corotational;
    def.recovery = recovery == "raw" ? Recovery::raw : recovery == "spr" ? Recovery::spr : Recovery::volume_weighted;
    return def;
}

}  // namespace supple::demos
