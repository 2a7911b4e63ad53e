// The same bar in Supple and in Bullet, step by step in turns.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "bullet_peer.h"
#include "machine.h"
#include "supple/base/clock.h"
#include "supple/io/report.h"
#include "supple/mesh/box_mesh.h"
#include "supple/world/world.h"

namespace supple::peers {

std::vector<double> Problem::vertex_mass_kg() const {
    std::vector<double> mass(mesh.vertices.size(), 0);
    for (const Tet& t : mesh.tets) {
        const auto x = [&](int i) -> const Vec3& { return mesh.vertices[std::size_t(t[std::size_t(i)])]; };
        for (const std::int32_t v : t) mass[std::size_t(v)] += density_kg_m3 * tet_volume(x(0), x(1), x(2), x(3)) / 4;
    }
    return mass;
}

namespace {

constexpr int kSteps = 100;

/// One linear solve a step, linearised at the prediction; or, to compare with, Newton until the step's equation holds.
class Supple final : public Peer {
public:
    Supple(const Problem& p, int threads, bool converged) : world_(def(p, threads, converged)), threads_(threads) {
        BodyDef body;
        body.shape = BodyTemplate::build(p.mesh);
        body.material = Corotational{.young_pa = p.young_pa, .poisson = p.poisson};
        body.density_kg_m3 = p.density_kg_m3;
        body_ = world_.add_body(body);
        world_.fix(body_, InsideBox{Vec3(-1, -1, -1), Vec3(1e-9, 1, 1)});
    }
    std::string name() const override { return "Supple, " + std::to_string(threads_) + (threads_ == 1 ? " thread" : " threads"); }
    int step() override {
        const StepReport report = world_.step();
        worst_residual_ = std::max(worst_residual_, report.cg_relative_residual);
        if (report.flags != StepFlag::none) flagged_ = true;
        return report.cg_iterations;
    }
    Vec3 position(std::size_t v) const override { return world_.positions(body_)[v]; }
    double worst_residual() const { return worst_residual_; }
    bool flagged() const { return flagged_; }

private:
    static WorldDef def(const Problem& p, int threads, bool converged) {
        WorldDef d;
        d.gravity_m_s2 = Vec3(0, -p.gravity_m_s2, 0);
        d.time_step_s = p.time_step_s;
        d.threads = threads;
        d.solver.cg_relative_tolerance = p.tolerance;
        d.solver.cg_max_iterations = p.most_iterations;
        if (converged) {
            d.solver.newton_iterations = 50;
            d.solver.newton_tolerance = 1e-7;
            d.solver.precision = Precision::double_;
            d.solver.tangent = Tangent::exact;
            d.solver.cg_max_iterations = 5000;
        }
        return d;
    }
    World world_;
    BodyId body_;
    int threads_;
    double worst_residual_ = 0;
    bool flagged_ = false;
};

Vec3 tip(const Peer& peer, const Problem& p) {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (std::size_t v = 0; v < p.mesh.vertices.size(); ++v) {
        if (p.mesh.vertices[v].x() < 0.4 - 1e-9) continue;
        sum += peer.position(v);
        ++count;
    }
    return sum / count;
}

/// Processor time of all threads of this process: what a step costs, whoever else is at work.
double cpu_ms() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * double(t.tv_sec) + 1e-6 * double(t.tv_nsec);
}

struct Row {
    Peer* peer;
    std::vector<double> ms, cpu_ms, iterations;
};

void compare(int cells) {
    Problem p;
    p.mesh = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3(0.4, 0.1, 0.1), .cells = {cells, cells / 4, cells / 4}});
    const int cores = demos::measure_machine().cores;
    Supple one(p, 1, false), all(p, cores, false), converged(p, cores, true);
    const std::unique_ptr<Peer> bullet = make_bullet(p);
    std::vector<Row> rows{{&one, {}, {}, {}}};
    if (cores > 1) rows.push_back({&all, {}, {}, {}});
    rows.push_back({bullet.get(), {}, {}, {}});
    for (int i = 0; i < kSteps; ++i) {
        for (Row& row : rows) {
            const double cpu_before = cpu_ms();
            const Stopwatch watch;
            row.iterations.push_back(row.peer->step());
            row.ms.push_back(watch.ms());
            row.cpu_ms.push_back(cpu_ms() - cpu_before);
        }
        converged.step();
    }
    const Vec3 goal = tip(converged, p);
    std::printf("\n%zu tets, %zu vertices: %d steps of %g ms from rest, to %.0e, at most %d iterations\nconverged step: tip (%.5f, %.5f, %.5f) m%s\n", p.mesh.tets.size(),
                p.mesh.vertices.size(), kSteps, 1e3 * p.time_step_s, p.tolerance, p.most_iterations, goal.x(), goal.y(), goal.z(),
                converged.flagged() ? " - NOT CONVERGED" : "");
    std::printf("| engine | median ms | p99 ms | CPU ms | iterations (most) | tip m | off by | faster | CPU |\n|---|--:|--:|--:|--:|---|--:|--:|--:|\n");
    const Row& slowest = rows.back();
    for (const Row& row : rows) {
        const Vec3 x = tip(*row.peer, p);
        double iterations = 0;
        for (const double n : row.iterations) iterations += n / double(row.iterations.size());
        std::printf("| %s | %.3f | %.3f | %.3f | %.1f (%.0f) | (%.5f, %.5f, %.5f) | %.2f %% | %.1fx | %.1fx |\n", row.peer->name().c_str(), io::median(row.ms),
                    io::percentile(row.ms, 0.99), io::median(row.cpu_ms), iterations, io::percentile(row.iterations, 1), x.x(), x.y(), x.z(), 100 * (x - goal).norm() / (goal - Vec3(0.4, 0.05, 0.05)).norm(),
                    io::median(slowest.ms) / io::median(row.ms), io::median(slowest.cpu_ms) / io::median(row.cpu_ms));
    }
    std::printf("Supple's true (float64) relative residual: at most %.1e. \"off by\": distance of the tip from the converged one, over how far that has moved.\n"
                "CPU: processor time of all threads, median; it does not grow with what else the machine does. faster, CPU: Bullet's medians over the row's.\n", std::max(one.worst_residual(), all.worst_residual()));
    std::fflush(stdout);
}

}  // namespace
}  // namespace supple::peers

int main(int argc, char** argv) {
    std::printf("%s\n", supple::demos::measure_machine().line().c_str());
    for (int i = 1; i < argc; ++i) {
        const int cells = std::atoi(argv[i]);
        if (cells < 4 || cells > 96 || cells % 4 != 0) {
            std::fprintf(stderr, "supple_peers: cells along x are a multiple of 4 from 4 to 96, not \"%s\"\n", argv[i]);
            return 2;
        }
        supple::peers::compare(cells);
    }
    return 0;
}
