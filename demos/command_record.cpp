#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "command.h"
#include "frame_builder.h"
#include "hud.h"
#include "open_show.h"
#include "output_files.h"
#include "progress.h"
#include "statistics.h"
#include "supple/base/clock.h"
#include "supple/base/error.h"
#include "supple/render/color_map.h"
#include "supple/render/context.h"
#include "supple/render/renderer.h"
#include "supple/render/video.h"

namespace supple::demos {
namespace {

namespace fs = std::filesystem;

struct RecordOptions {
    std::string scene, out;
    std::string size = "1280x720";
    std::size_t frames = 0;  ///< 0 = the duration of the show
    double frames_per_s = 60;
    std::size_t stills = 0;
    ShowOptions show;
    FrameOptions frame;
    std::string color_by, stress_at = "vertex", range;
    bool no_stress = false;
    bool quiet = false;
};

/// Where the pictures go: a video, or numbered PNG files in a folder; a few stills beside the video.
class Output {
public:
    Output(const RecordOptions& o, int width, int height, std::size_t frames) : out_(o.out), frames_(frames), stills_(o.stills) {
        const std::string ending = out_.extension().string();
        if (ending.empty()) {
            fs::create_directories(out_);
        } else if (ending == ".mp4" || ending == ".mkv" || ending == ".mov") {
            if (out_.has_parent_path()) fs::create_directories(out_.parent_path());
            require_writable(out_);
            video_.emplace(VideoDef{.path = out_.string(), .width = width, .height = height, .frames_per_s = o.frames_per_s});
        } else {
            throw Error(ErrorCode::unsupported, "--out " + o.out, "\"" + ending + "\" is neither a video (.mp4, .mkv, .mov) nor a folder (no ending)");
        }
    }

    void write(const Image& image, std::size_t frame) {
        if (!video_) {
            char name[32];
            std::snprintf(name, sizeof name, "frame_%05zu.png", frame);
            write_png((out_ / name).string(), image);
            return;
        }
        video_->write(image);
        // Still i of n shows the middle of the i-th of n equal parts.
        for (std::size_t i = 0; i < stills_; ++i) {
            if (frame != (2 * i + 1) * frames_ / (2 * stills_)) continue;
            fs::path file = out_;
            file.replace_filename(out_.stem().string() + "_" + std::to_string(i + 1) + ".png");
            write_png(file.string(), image);
        }
    }

    void finish() {
        if (video_) video_->finish();
    }

private:
    fs::path out_;
    std::size_t frames_, stills_;
    std::optional<VideoWriter> video_;
};

std::array<double, 2> read_range(const std::string& text) {
    double low = 0, high = 0;
    int used = 0;
    if (std::sscanf(text.c_str(), "%lf,%lf%n", &low, &high, &used) != 2 || used != static_cast<int>(text.size()) || !(low < high) ||
        !std::isfinite(low) || !std::isfinite(high))
        throw Error(ErrorCode::invalid_argument, "--range " + text, "is not LOW,HIGH in Pa with LOW below HIGH, e.g. 0,5000");
    return {low, high};
}

void print_report(const RecordOptions& o, const HeadlessContext& context, const World& world, const StepStatistics& steps,
                  const std::vector<double>& frame_ms) {
    const io::RunSummary w = summary_of(world);
    std::printf("%s: %zu frames drawn with %s\n", fs::absolute(o.out).lexically_normal().c_str(), frame_ms.size(), context.description().c_str());
    std::printf("%zu elements, %zu vertices, %zu steps of %.4g ms simulated time on %d thread%s, while frames were drawn and encoded\n%s", w.elements,
                w.vertices, steps.steps(), 1000 * w.time_step_s, w.threads, w.threads == 1 ? "" : "s", steps.table().c_str());
    std::printf("  %-12s %9.3f %9.3f %9.3f   (per frame)\n", "draw", io::median(frame_ms), io::percentile(frame_ms, 0.99),
                io::percentile(frame_ms, 0.999));
    std::printf("  %.1f iterations a step (mean), relative residual %.2g (median)\n", mean(steps.iterations()), io::median(steps.residuals()));
}

int record(RecordOptions o) {
    int width = 0, height = 0;
    read_size(o.size, width, height);
    color_map(o.frame.map);  // refuses an unknown name before anything is computed
    if (o.color_by == "stress") o.frame.color_by = ColorBy::stress;
    if (o.color_by == "stiffness") o.frame.color_by = ColorBy::stiffness;
    if (o.no_stress) o.frame.color_by = ColorBy::nothing;
    o.frame.stress_at = o.stress_at == "element" ? FrameOptions::At::element : o.stress_at == "point" ? FrameOptions::At::point : FrameOptions::At::vertex;
    if (!o.range.empty()) o.frame.range_pa = read_range(o.range);
    const OpenedShow opened = open_show(o.scene, o.show);
    Show& show = *opened.show;
    World& world = show.world();
    const std::size_t frames = o.frames > 0 ? o.frames : static_cast<std::size_t>(std::llround(show.duration_s() * o.frames_per_s));
    Output output(o, width, height, frames);
    HeadlessContext context;
    for (const std::string& failure : context.failures()) std::fprintf(stderr, "supple: %s\n", failure.c_str());
    Renderer renderer({.width = width, .height = height});
    FrameBuilder builder(show, o.frame);
    Hud hud(world);
    StepStatistics statistics;
    std::vector<double> frame_ms;
    Image image;
    const double h = world.def().time_step_s, start_s = world.time_s();
    {
        Progress progress(opened.name, frames, o.quiet);
        for (std::size_t frame = 0; frame < frames; ++frame) {
            const double frame_s = start_s + static_cast<double>(frame) / o.frames_per_s;
            while (world.time_s() < frame_s - 1e-9) {
                show.before_step();
                const StepReport report = world.step();
                statistics.add(world, report);
                hud.add(report);
            }
            const Stopwatch watch;
            const double alpha = std::clamp(1 - (world.time_s() - frame_s) / h, 0.0, 1.0);
            renderer.draw(builder.build(alpha, hud.text(), 1 / o.frames_per_s));
            renderer.read_pixels(image);
            frame_ms.push_back(watch.ms());
            output.write(image, frame);
            progress.show(frame + 1);
        }
        output.finish();
    }
    if (!o.quiet) print_report(o, context, world, statistics, frame_ms);
    std::fputs(statistics.flag_sentences().c_str(), stderr);
    return statistics.flags().empty() ? kAllWell : kRunFailed;
}

}  // namespace

void read_size(const std::string& text, int& width, int& height) {
    int used = 0;
    if (std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &used) != 2 || used != static_cast<int>(text.size()))
        throw Error(ErrorCode::invalid_argument, "--size " + text, "is not WIDTHxHEIGHT, e.g. 1280x720");
}

void add_record_command(CLI::App& app, int& status) {
    auto o = std::make_shared<RecordOptions>();
    CLI::App* command = app.add_subcommand("record", "record a scene file or a demo to a video or PNG frames, without a display");
    command->add_option("scene", o->scene, "scene file, or name of a demo")->required();
    command->add_option("--out", o->out, "video (.mp4, .mkv, .mov), or a folder for PNG frames")->required();
    command->add_option("--frames", o->frames, "frames to draw [the whole show]")->check(CLI::Range(1, 10000000));
    command->add_option("--size", o->size, "WIDTHxHEIGHT [1280x720]");
    command->add_option("--fps", o->frames_per_s, "frames per second [60]")->check(CLI::Range(1.0, 1000.0));
    command->add_option("--stills", o->stills, "also write so many PNG pictures beside the video")->check(CLI::Range(1, 1000));
    command->add_option("--map", o->frame.map, "colour map [viridis]");
    CLI::Option* color_by = command->add_option("--color-by", o->color_by, "stress (von Mises) or stiffness (Young's modulus) [stress, or what the demo shows]")
                                ->check(CLI::IsMember({"stress", "stiffness"}));
    command->add_flag("--no-stress", o->no_stress, "plain material instead of a colour map")->excludes(color_by);
    command->add_option("--stress-at", o->stress_at, "stress map: vertex (smooth), element (flat) or point (inside a translucent body) [vertex]")
        ->check(CLI::IsMember({"vertex", "element", "point"}));
    command->add_option("--range", o->range, "LOW,HIGH of the colours [Pa] [automatic: smoothed, 99 % of the stresses]");
    command->add_option("--opacity", o->frame.opacity, "of the bodies, 0.01..1 [1; with points 0.25]")->check(CLI::Range(0.01, 1.0));
    command->add_flag("--contacts", o->frame.contacts, "draw the forces of contacts as arrows");
    command->add_flag("--wireframe", o->frame.wireframe, "draw the edges of the elements");
    command->add_option("--threads", o->show.threads, "threads [those of the scene, or all cores]")->check(CLI::Range(1, 256));
    command->add_flag("--quiet", o->quiet, "no progress bar and no table");
    command->callback([o, &status] { status = record(*o); });
}

}  // namespace supple::demos
