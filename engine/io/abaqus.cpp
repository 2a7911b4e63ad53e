#include <cctype>
#include <map>

#include "supple/io/element_sets.h"
#include "supple/io/keyword_lines.h"
#include "supple/io/volume_formats.h"

namespace supple::io {

namespace {

constexpr std::int64_t kMostGenerated = 10'000'000;

bool starts_with(std::string_view text, std::string_view head) { return text.substr(0, head.size()) == head; }

class Abaqus {
public:
    explicit Abaqus(const MeshSource& source) : reader_(source, "**", false) {}

    void read(MeshBuilder& builder) {
        KeywordLine line;
        while (reader_.next(line)) {
            if (line.is_keyword()) {
                end_element();
                begin_section(line);
            } else if (section_ == "node") {
                read_node(line, builder);
            } else if (section_ == "element") {
                read_element(line);
            } else if (section_ == "nset" || section_ == "elset") {
                read_set(line);
            } else if (section_ == "instance") {
                check_instance(line);
            }
        }
        end_element();
        builder.close_vertices(reader_.file());
        for (auto& [name, ids] : node_sets_) {
            if (is_shadowed(name)) continue;
            builder.add_vertex_group(reader_.file(), nullptr, name, ids);
        }
        builder.note_lower_elements(1, others_);
        elements_.feed(reader_.file(), regions_, builder);
    }

private:
    /// CalculiX writes node sets of the same name as element sets (generated ones): the region already selects these vertices.
    bool is_shadowed(const std::string& name) const { return elements_.has_set(name); }

    void begin_section(const KeywordLine& line) {
        section_ = line.keyword();
        set_.clear();
        generate_ = line.parameter("generate").has_value();
        if (section_ == "include" || ((section_ == "node" || section_ == "element") && line.parameter("input"))) {
            const auto file = line.parameter("input");
            if (!file) line.fail("*INCLUDE needs INPUT=file");
            const std::string keyword = section_;
            if (keyword == "include") section_.clear();
            include_after_ = *file;
        }
        if (section_ == "node") {
            if (const auto name = line.parameter("nset")) set_ = std::string(*name);
            if (const auto system = line.parameter("system"); system && plain_lower(*system) != "r")
                line.fail("nodes in cylindrical or spherical coordinates are not read; save them in rectangular ones",
                          ErrorCode::unsupported);
        } else if (section_ == "element") {
            begin_elements(line);
        } else if (section_ == "nset" || section_ == "elset") {
            const auto name = line.parameter(section_);
            if (!name || name->empty()) line.fail("*" + section_ + " needs " + section_ + "=name");
            set_ = std::string(*name);
            if (section_ == "elset") elements_.set(set_);
        } else if (section_ == "solidsection") {
            if (const auto name = line.parameter("elset")) regions_.push_back(std::string(*name));
        } else if (section_ == "part") {
            if (++parts_ > 1)
                line.fail(
                    "a second *PART; only one is read: save a flat input file (Abaqus: Model > Edit Attributes > Do not use parts and "
                    "assemblies in input files)",
                    ErrorCode::unsupported);
        } else if (section_ == "system" || section_ == "ncopy" || section_ == "ngen" || section_ == "nfill" || section_ == "elgen" ||
                   section_ == "elcopy") {
            line.fail("*" + section_ + " generates or moves nodes or elements, which is not read; write them out", ErrorCode::unsupported);
        }
        if (!include_after_.empty()) {
            const std::string file(include_after_);
            include_after_ = {};
            reader_.include(line, file);
        }
    }

    void begin_elements(const KeywordLine& line) {
        const auto type = line.parameter("type");
        if (!type) line.fail("*ELEMENT needs TYPE=");
        std::string name = plain_lower(*type);
        for (char& c : name) c = char(std::toupper(static_cast<unsigned char>(c)));
        type_ = nullptr;
        // After the name letters follow that choose the formulation: C3D8RH, S4R5.
        const auto is_family = [&](std::string_view family) {
            return starts_with(name, family) &&
                   (name.size() == family.size() || !std::isdigit(static_cast<unsigned char>(name[family.size()])));
        };
        if (is_family("C3D4") || is_family("DC3D4")) type_ = &kTetType;
        if (is_family("C3D8") || is_family("DC3D8")) type_ = &kHexType;
        for (const char* family : {"S3", "STRI3", "CPS3", "CPE3", "CAX3", "M3D3", "R3D3", "SFM3D3", "F3D3"})
            if (is_family(family)) type_ = &kTriangleType;
        for (const char* family : {"S4", "CPS4", "CPE4", "CAX4", "M3D4", "R3D4", "SFM3D4"})
            if (is_family(family)) type_ = &kQuadType;
        if (!type_ && (starts_with(name, "C3D") || starts_with(name, "DC3D") || starts_with(name, "SC")))
            line.fail("elements of the type " + name + " cannot be simulated; mesh the part with C3D4 or C3D8", ErrorCode::unsupported);
        if (const auto set = line.parameter("elset")) {
            set_ = std::string(*set);
            elements_.set(set_);
        }
    }

    void read_node(const KeywordLine& line, MeshBuilder& builder) {
        const std::int64_t id = line.integer(0, "the number of a node");
        Vec3 x = Vec3::Zero();  // what is left out is zero
        for (int axis = 0; axis < 3; ++axis) {
            const std::size_t field = std::size_t(axis) + 1;
            if (field < line.fields.size() && !line.fields[field].empty()) x[axis] = line.real(field, "a coordinate of a node");
        }
        const bool outer = line.scanner == &reader_.file();  // places in other files cannot be told later
        builder.add_vertex(id, x, outer ? line.position : nullptr);
        if (!set_.empty()) node_set(set_).push_back(id);
    }

    std::vector<std::int64_t>& node_set(const std::string& name) {
        const auto [entry, is_new] = node_index_.try_emplace(name, node_sets_.size());
        if (is_new) node_sets_.emplace_back(name, std::vector<std::int64_t>());
        return node_sets_[entry->second].second;
    }

    /// An element may go over several lines.
    void read_element(const KeywordLine& line) {
        if (!type_) {
            ++others_;
            return;
        }
        std::size_t field = 0;
        if (!pending_) {
            pending_id_ = line.integer(field++, "the number of an element");
            pending_ = true;
            first_line_ = line;
            vertices_.clear();
        }
        for (; field < line.fields.size(); ++field) {
            if (line.fields[field].empty() && field + 1 == line.fields.size()) break;
            vertices_.push_back(line.integer(field, "a node of an element"));
        }
        if (vertices_.size() >= std::size_t(type_->vertex_count)) end_element();
    }

    void end_element() {
        if (!pending_) return;
        pending_ = false;
        if (vertices_.size() != std::size_t(type_->vertex_count))
            first_line_.fail("the element has " + std::to_string(vertices_.size()) + " nodes, but a " + type_->name + " has " +
                             std::to_string(type_->vertex_count));
        elements_.add_element(pending_id_, *type_, vertices_, *first_line_.scanner, first_line_.position);
        if (!set_.empty()) elements_.set(set_).push_back(pending_id_);
    }

    void read_set(const KeywordLine& line) {
        std::vector<std::int64_t> ids;
        if (generate_) {
            const std::int64_t first = line.integer(0, "the first number"), last = line.integer(1, "the last number");
            const std::int64_t step = line.fields.size() > 2 && !line.fields[2].empty() ? line.integer(2, "the step") : 1;
            if (step <= 0 || last < first || std::uint64_t(last) - std::uint64_t(first) > std::uint64_t(kMostGenerated) ||
                (generated_ += (last - first) / step + 1) > kMostGenerated)
                line.fail("the set goes from " + std::to_string(first) + " to " + std::to_string(last) + " by steps of " +
                          std::to_string(step) + "; the step must be positive, and sets generate at most " +
                          std::to_string(kMostGenerated) + " numbers");
            for (std::int64_t id = first; id <= last; id += step) ids.push_back(id);
        } else {
            for (std::size_t f = 0; f < line.fields.size(); ++f) {
                const std::string_view word = line.fields[f];
                if (word.empty()) continue;
                const bool is_number = std::isdigit(static_cast<unsigned char>(word.front()));
                if (is_number) {
                    ids.push_back(line.integer(f, "a number"));
                    continue;
                }
                // The name of another set that was told before.
                const std::string other(word);
                const std::vector<std::int64_t>* list = nullptr;
                if (section_ == "elset" && elements_.has_set(other)) list = &elements_.set(other);
                if (section_ == "nset" && node_index_.contains(other)) list = &node_set(other);
                if (!list) line.fail("the set " + quoted(word) + " is not known here");
                if ((generated_ += std::int64_t(list->size())) > kMostGenerated)
                    line.fail("sets of sets hold more than " + std::to_string(kMostGenerated) + " numbers");
                ids.insert(ids.end(), list->begin(), list->end());
            }
        }
        std::vector<std::int64_t>& target = section_ == "elset" ? elements_.set(set_) : node_set(set_);
        target.insert(target.end(), ids.begin(), ids.end());
    }

    /// The lines of an instance move it.
    void check_instance(const KeywordLine& line) const {
        for (std::size_t f = 0; f < line.fields.size(); ++f)
            if (!line.fields[f].empty() && line.real(f, "a number of the instance's position") != 0)
                line.fail("the instance is moved from where its part lies, which is not read; save a flat input file",
                          ErrorCode::unsupported);
    }

    KeywordReader reader_;
    ElementSets elements_;
    std::vector<std::pair<std::string, std::vector<std::int64_t>>> node_sets_;
    std::map<std::string, std::size_t> node_index_;
    std::vector<std::string> regions_;
    std::string section_, set_;
    std::string_view include_after_;
    bool generate_ = false, pending_ = false;
    const ElementType* type_ = nullptr;
    std::int64_t pending_id_ = 0, generated_ = 0;
    KeywordLine first_line_;
    std::vector<std::int64_t> vertices_;
    std::size_t others_ = 0;
    int parts_ = 0;
};

}  // namespace

void read_abaqus(const MeshSource& source, MeshBuilder& builder) { Abaqus(source).read(builder); }

}  // namespace supple::io
