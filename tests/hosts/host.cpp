// A host in C++: the same calls with owners that free and errors that throw, and a node that fails.
//   host GRAPH.tenon.json
#include "tenon.h"
#include <cstdint>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace tenon {

struct Free {
    void operator()(tenon_engine *h) const { tenon_engine_free(h); }
    void operator()(tenon_graph *h) const { tenon_graph_free(h); }
    void operator()(tenon_result *h) const { tenon_result_free(h); }
    void operator()(tenon_text *h) const { tenon_text_free(h); }
};
template <class T> using Owned = std::unique_ptr<T, Free>;

std::string_view view(tenon_str text) { return {text.ptr, static_cast<std::size_t>(text.len)}; }

void must(tenon_error *error) {
    if (error == nullptr) return;
    std::string message(view(tenon_error_message(error)));
    tenon_error_free(error);
    throw std::runtime_error(message);
}

class Graph {
  public:
    Graph(const Owned<tenon_engine> &engine, const std::string &json) {
        tenon_graph *graph = nullptr;
        must(tenon_graph_load(engine.get(), json.data(), json.size(), nullptr, &graph));
        handle.reset(graph);
    }
    void set(const char *name, double value) { must(tenon_graph_set_number(handle.get(), name, value)); }
    void set(const char *name, const std::string &json) { must(tenon_graph_set(handle.get(), name, json.c_str())); }
    std::string interface(tenon_side_of_graph side) const {
        tenon_text *text = nullptr;
        must(tenon_graph_interface(handle.get(), side, &text));
        Owned<tenon_text> owned(text);
        return std::string(view(tenon_text_get(owned.get())));
    }
    Owned<tenon_result> evaluate(const std::vector<const char *> &outputs) {
        tenon_result *result = nullptr;
        must(tenon_graph_evaluate(handle.get(), outputs.data(), outputs.size(), nullptr, &result));
        return Owned<tenon_result>(result);
    }

  private:
    Owned<tenon_graph> handle;
};

template <class T> const T &item(const Owned<tenon_result> &result, const char *name, tenon_kind kind) {
    tenon_tree tree = {};
    tree.size = sizeof tree;
    must(tenon_result_output(result.get(), name, &tree));
    const tenon_column &column = tree.branches[0].column;
    if (column.kind != kind || column.count != 1) throw std::runtime_error("unexpected type");
    return *static_cast<const T *>(column.items);
}

} // namespace tenon

static void check(bool good, const char *what) {
    if (!good) throw std::runtime_error(what);
}

int main(int argc, char **argv) try {
    check(argc == 2, "usage: host GRAPH");
    {
        std::ifstream file(argv[1], std::ios::binary);
        std::string json((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
        tenon_engine *made = nullptr;
        tenon::must(tenon_engine_new(nullptr, &made));
        tenon::Owned<tenon_engine> engine(made);

        // Two threads, each with a graph of its own.
        std::vector<std::uint64_t> counts(2);
        std::vector<std::thread> threads;
        for (int t = 0; t < 2; t++) {
            threads.emplace_back([&, t] {
                tenon::Graph graph(engine, json);
                graph.set("iterations", 2.0 + t);
                counts[t] = tenon::item<tenon_panels>(graph.evaluate({"panels"}), "panels", TENON_PANELS).panel_count;
            });
        }
        for (std::thread &thread : threads) thread.join();
        check(counts[0] == 16 && counts[1] == 64, "panels of two graphs at once");

        tenon::Graph graph(engine, json);
        auto result = graph.evaluate({"panels"});
        std::cout << tenon::item<tenon_panels>(result, "panels", TENON_PANELS).panel_count << " panels\n";

        // The interface tells what a dialog needs.
        check(graph.interface(TENON_INPUTS).find("\"min\":4.0,\"max\":30.0") != std::string::npos, "ranges of inputs");
        check(graph.interface(TENON_OUTPUTS).find("\"type\":\"panels\"") != std::string::npos, "types of outputs");

        // A node that fails says where and why; no exception is lost on the way.
        graph.set("fold_1.x", std::string("1e300"));
        auto failed = graph.evaluate({"panels"});
        check(tenon_result_status(failed.get()) == TENON_FAILED, "must fail");
        check(tenon_result_diagnostic_count(failed.get()) > 0, "must say why");
        tenon_diagnostic diagnostic = {};
        diagnostic.size = sizeof diagnostic;
        tenon::must(tenon_result_diagnostic(failed.get(), 0, &diagnostic));
        check(diagnostic.severity == TENON_ERROR && diagnostic.node.len > 0, "must name the node");
        std::cout << tenon::view(diagnostic.node) << ": " << tenon::view(diagnostic.message) << "\n";
        bool thrown = false;
        try {
            graph.set("no_such_input", 1.0);
        } catch (const std::runtime_error &error) {
            thrown = std::string(error.what()).find("no_such_input") != std::string::npos;
        }
        check(thrown, "an unknown name must be refused");
    }
    check(tenon_handle_count() == 0, "everything is freed");
    return 0;
} catch (const std::exception &error) {
    std::cerr << error.what() << "\n";
    return 1;
}
