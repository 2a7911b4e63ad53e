#include "bench/haptic_scorecard.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>

#include "bench/haptic_rig.h"
#include "json_text.h"
#include "supple/base/error.h"

namespace supple::demos {

namespace {

using haptics::DeviceLimits;
using haptics::device_preset;

constexpr double kStiffBlock_pa = 1e6;      // tens of newtons a millimetre: all that gives is the coupling
constexpr double kLeastEnergy_mj = -1;      // what the rendering may give more than it took
constexpr double kCalm_um = 60;             // three steps of the encoder: a handle that moves less is at rest
constexpr double kGrid = 1.2;               // stiffnesses are tried in steps of a fifth

/// One table at a time, and its numbers.
class Card {
public:
    Card(FunctionRef<void(const std::string&)> print, std::vector<ScoreLine>& lines) : print_(print), lines_(lines) {}
    void text(const std::string& line) { print_(line + "\n"); }
    /// @param relative, least  tolerance = the larger of relative |value| and least
    void add(const std::string& row, const std::string& what, double value, double relative, double least, Worse worse, const std::string& demand = {}, bool good = true) {
        lines_.push_back({row + " " + what, value, std::max(relative * std::abs(value), least), worse, good, demand});
        if (!good) text("    does not hold: " + what + " " + demand);
    }

private:
    FunctionRef<void(const std::string&)> print_;
    std::vector<ScoreLine>& lines_;
};

std::string format(const char* pattern, auto... values) {
    char line[256];
    std::snprintf(line, sizeof line, pattern, values...);
    return line;
}

/// What must hold of every run.
void demands(Card& card, const std::string& row, const HapticRun& run, const DeviceLimits& limits, bool energy = true) {
    card.add(row, "peak_force_n", run.peak_force_n, 0.05, 0.02, Worse::either, "<= the device's limit, finite", run.finite && run.peak_force_n <= limits.force_n * (1 + 1e-9));
    card.add(row, "peak_slew_n_ms", run.peak_slew_n_ms, 0.25, 0.05, Worse::higher, "<= what is stated", run.peak_slew_n_ms <= run.stated_slew_n_ms * (1 + 1e-9));
    if (energy) card.add(row, "lowest_energy_mj", run.lowest_mj, 0.3, 0.05, Worse::lower, ">= -1 mJ", run.lowest_mj >= kLeastEnergy_mj);
}

bool stable(HapticRigDef def, double K) {
    def.coupling_n_m = K;
    const HapticRun run = run_haptic_rig(def);
    return run.finite && run.limit_cycle_um <= kCalm_um && run.lowest_mj >= kLeastEnergy_mj;
}

/// The stiffest coupling on the grid with which a pressed handle comes to rest, of 100 N/m and more; 0: not even that.
double most_stable_stiffness(const HapticRigDef& def) {
    int low = -1, high = 32;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        (stable(def, 100 * std::pow(kGrid, middle)) ? low : high) = middle;
    }
    return low < 0 ? 0 : 100 * std::pow(kGrid, low);
}

struct Rates {
    double simulation, haptic;
    std::string name() const { return format("sim=%.0f haptic=%.0f", simulation, haptic); }
};

std::vector<Rates> rates(bool quick) {
    if (quick) return {{60, 1000}};
    std::vector<Rates> all;
    for (const double haptic : {1000.0, 4000.0})
        for (const double simulation : {30.0, 60.0, 120.0, 240.0}) all.push_back({simulation, haptic});
    return all;
}

/// A pressed and dragged ball against a simulation at 1 kHz.
void fidelity(Card& card, bool quick) {
    HapticRigDef def;
    def.limits = device_preset("omega_x");
    def.coupling_n_m = 1000;
    def.played = true;
    def.path = press_and_slide();
    def.seconds = 1.2;
    card.text("Fidelity: a ball pressed 6 mm into soft tissue at 60 mm/s, dragged and lifted, against a simulation at 1 kHz");
    card.text("  sim Hz  haptic Hz   rms error N  of peak %  penetration mm  hand-over N  peak slew N/ms  energy mJ  model us");
    const std::vector<Vec3> reference = reference_force(def);
    double peak = 0;
    for (const Vec3& f : reference) peak = std::max(peak, f.norm());
    for (const Rates& r : rates(quick)) {
        def.simulation_hz = r.simulation;
        def.haptic_hz = r.haptic;
        const HapticRun run = run_haptic_rig(def);
        double sum = 0;
        const auto each = std::size_t(std::lround(r.haptic / 1000));
        std::size_t n = 0;
        for (std::size_t i = 0; i < reference.size(); ++i) {
            if (run.gain[(i + 1) * each - 1] < 1) continue;
            sum += (run.force_n[(i + 1) * each - 1] - reference[i]).squaredNorm();
            ++n;
        }
        const double rms = std::sqrt(sum / double(n));
        card.text(format("  %6.0f  %9.0f  %12.4f  %9.2f  %14.4f  %11.4f  %14.4f  %9.4f  %8.0f", r.simulation, r.haptic, rms, 100 * rms / peak, run.penetration_mm, run.jump_n,
                         run.peak_slew_n_ms, run.lowest_mj, run.model_us));
        const std::string row = "fidelity " + r.name();
        card.add(row, "rms_error_n", rms, 0.1, 0.005, Worse::higher);
        card.add(row, "penetration_mm", run.penetration_mm, 0.2, 0.005, Worse::higher);
        card.add(row, "hand_over_jump_n", run.jump_n, 0.25, 0.02, Worse::higher);
        demands(card, row, run, def.limits);
    }
    card.text(format("  peak of the reference %.3f N", peak));
    card.add("fidelity reference", "peak_n", peak, 0.02, 0.005, Worse::either);
}

/// How stiff a coupling may be on a hard block.
void stiffness(Card& card, bool quick) {
    card.text("Largest stable coupling [N/m] on a hard block, 1.5 N and no hand (falcon: limit 3000 N/m, own damping 1.5 Ns/m): without and with the passivity controller");
    card.text("  sim Hz  haptic Hz   without      with");
    for (const Rates& r : rates(quick)) {
        HapticRigDef def;
        def.limits = device_preset("falcon");
        def.simulation_hz = r.simulation;
        def.haptic_hz = r.haptic;
        def.young_pa = kStiffBlock_pa;
        def.held = false;
        def.seconds = 1.6;
        def.passivity = false;
        const double without = most_stable_stiffness(def);
        def.passivity = true;
        const double with = most_stable_stiffness(def);
        card.text(format("  %6.0f  %9.0f  %8.0f  %8.0f", r.simulation, r.haptic, without, with));
        card.add("stiffness " + r.name(), "without_n_m", without, kGrid - 1 + 0.01, 1, Worse::lower);
        card.add("stiffness " + r.name(), "with_n_m", with, kGrid - 1 + 0.01, 1, Worse::lower, ">= 0.8 of the device's limit", with >= 0.8 * def.limits.stiffness_n_m / kGrid);
    }
}

/// Every device with the coupling that its limits give: on tissue with a hand, on a hard block with nobody.
void devices(Card& card, bool quick) {
    card.text("Devices at 60 Hz and 1 kHz with their own coupling: a hand that presses tissue and lets go; nobody, and 1 N on a hard block");
    card.text("  device        tissue: energy mJ  slew N/ms   hard: energy mJ  slew N/ms  limit cycle um   largest stable N/m");
    for (const DeviceLimits& d : haptics::device_presets()) {
        if (quick && d.name != "touch" && d.name != "lambda_7") continue;
        HapticRigDef tissue;
        tissue.limits = d;
        tissue.path = press_and_slide();
        tissue.seconds = 1.2;
        const HapticRun soft = run_haptic_rig(tissue);
        HapticRigDef block;
        block.limits = d;
        block.young_pa = kStiffBlock_pa;
        block.held = false;
        block.push_n = 1;
        block.seconds = 1.6;
        const HapticRun hard = run_haptic_rig(block);
        const double K = quick ? 0 : most_stable_stiffness(block);
        card.text(format("  %-12s  %17.4f  %9.4f  %16.4f  %9.4f  %14.1f   %18.0f", std::string(d.name).c_str(), soft.lowest_mj, soft.peak_slew_n_ms, hard.lowest_mj, hard.peak_slew_n_ms,
                         hard.limit_cycle_um, K));
        const std::string row = "device " + std::string(d.name);
        demands(card, row + " tissue", soft, d);
        demands(card, row + " hard", hard, d);
        card.add(row + " hard", "limit_cycle_um", hard.limit_cycle_um, 0.5, 20, Worse::higher, "<= 60 um", hard.limit_cycle_um <= kCalm_um);
        if (!quick) card.add(row + " hard", "stable_n_m", K, kGrid - 1 + 0.01, 1, Worse::lower);
    }
}

/// What must not be felt as a blow.
void events(Card& card) {
    card.text("Events while a hand holds a ball 6 mm deep in tissue (touch, 60 Hz, 1 kHz): from 0.5 s to 0.7 s");
    card.text("  event             force before N  slew within N/ms  zero after ms  slew after N/ms  force at the end N");
    const struct {
        const char* name;
        HapticEvent event;
    } all[] = {{"none", HapticEvent::none}, {"grab, release", HapticEvent::grab_and_release}, {"200 ms stall", HapticEvent::stall}, {"NaN readings", HapticEvent::bad_reading}, {"unplugged", HapticEvent::unplug}};
    for (const auto& e : all) {
        HapticRigDef def;
        def.limits = device_preset("touch");
        def.path = press_and_slide();
        def.path.times_s.resize(4);
        def.path.positions_m.resize(4);  // stays down
        if (e.event == HapticEvent::grab_and_release) {  // and lifts what it holds
            def.path.times_s.insert(def.path.times_s.end(), {0.55, 0.65});
            const Vec3 down = def.path.positions_m.back();
            def.path.positions_m.insert(def.path.positions_m.end(), {down, Vec3(down + Vec3(0, 0.014, 0))});
        }
        def.event = e.event;
        def.seconds = 1.2;
        const HapticRun run = run_haptic_rig(def);
        double zero_ms = 0;
        for (std::size_t i = 0; i < run.time_s.size() && zero_ms == 0; ++i)
            if (run.time_s[i] >= def.event_s && run.force_n[i].norm() == 0) zero_ms = (run.time_s[i] - def.event_s) * 1e3;
        const double before = run.force_at(def.event_s - 0.01), within = run.slew_between(def.event_s - 0.001, def.event_end_s), after = run.slew_between(def.event_end_s, 1.2);
        card.text(format("  %-16s  %14.3f  %16.4f  %13.1f  %15.4f  %18.3f", e.name, before, within, zero_ms, after, run.force_n.back().norm()));
        const std::string row = std::string("event ") + e.name;
        const double stated = run.stated_slew_n_ms * (1 + 1e-9);
        card.add(row, "force_before_n", before, 0.05, 0.01, Worse::either);
        card.add(row, "slew_within_n_ms", within, 0.25, 0.02, Worse::higher, "<= what is stated; a pulled plug has no force", e.event == HapticEvent::unplug || within <= stated);
        card.add(row, "slew_after_n_ms", after, 0.25, 0.02, Worse::higher, "<= what is stated", after <= stated);
        if (e.event == HapticEvent::grab_and_release) {
            const double pull = run.force_at(def.event_end_s - 0.002);
            card.text(format("    pulls with %.3f N before it is let go", pull));
            card.add(row, "pull_n", pull, 0.05, 0.01, Worse::either, "> 0.1 N", pull > 0.1);
        }
        card.add(row, "force_at_end_n", run.force_n.back().norm(), 0.05, 0.01, Worse::either);
        if (e.event == HapticEvent::stall) card.add(row, "zero_after_ms", zero_ms, 0, 17, Worse::higher, "<= 100 ms", zero_ms > 0 && zero_ms <= 100);
        if (e.event == HapticEvent::bad_reading) card.add(row, "zero_after_ms", zero_ms, 0, 2, Worse::higher, "<= 100 ms", zero_ms > 0 && zero_ms <= 100);
        card.add(row, "finite", run.finite ? 1 : 0, 0, 0, Worse::either, "yes", run.finite);
    }
}

}  // namespace

std::vector<ScoreLine> haptic_scorecard(bool quick, FunctionRef<void(const std::string&)> print) {
    std::vector<ScoreLine> lines;
    Card card(print, lines);
    fidelity(card, quick);
    stiffness(card, quick);
    devices(card, quick);
    events(card);
    return lines;
}

std::string regression_text(const std::vector<ScoreLine>& lines) {
    std::string out = "# supple bench haptics: name = value +- tolerance\n";
    for (const ScoreLine& l : lines) out += l.name + format(" = %.6g +- %.2g\n", l.value, l.tolerance);
    return out;
}

std::vector<std::string> differences(const std::vector<ScoreLine>& lines, const std::string& file) {
    std::ifstream in(file);
    if (!in) throw Error(ErrorCode::file_unreadable, file, "cannot be opened");
    std::vector<std::string> found;
    std::map<std::string, std::pair<double, double>> known;
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        if (line.empty() || line[0] == '#') continue;
        const auto equals = line.find(" = "), pm = line.find(" +- ");
        if (equals == std::string::npos || pm == std::string::npos)
            throw Error(ErrorCode::parse, file + ":" + std::to_string(number), "\"" + line + "\" is not a line name = value +- tolerance");
        known[line.substr(0, equals)] = {std::strtod(line.c_str() + equals + 3, nullptr), std::strtod(line.c_str() + pm + 4, nullptr)};
    }
    for (const ScoreLine& l : lines) {
        const auto at = known.find(l.name);
        if (at == known.end()) {
            found.push_back(l.name + " is not in " + file);
            continue;
        }
        const auto [value, tolerance] = at->second;
        const double change = l.value - value, loss = l.worse == Worse::higher ? change : l.worse == Worse::lower ? -change : std::abs(change);
        const char* may = l.worse == Worse::higher ? "rise" : l.worse == Worse::lower ? "fall" : "differ";
        if (!(loss <= tolerance)) found.push_back(l.name + format(" is %.6g, was %.6g, may %s by %.2g", l.value, value, may, tolerance));
        known.erase(at);
    }
    for (const auto& [name, value] : known) found.push_back(name + " was not measured");
    return found;
}

std::string json_of(const std::vector<ScoreLine>& lines) {
    JsonObject all;
    for (const ScoreLine& l : lines) {
        JsonObject one;
        one.add("value", json(l.value)).add("tolerance", json(l.tolerance)).add("holds", l.good ? "true" : "false");
        if (!l.demand.empty()) one.add("demand", json(std::string_view(l.demand)));
        all.add(l.name, one.line());
    }
    return all.block(1);
}

}  // namespace supple::demos
