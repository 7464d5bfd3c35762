//! The whole tree: merge, entwine, graft, flatten, simplify, partition.

use std::collections::BTreeSet;
use tenon_engine::stop::{Pending, Stoppable};
use tenon_engine::{Access, Call, Column, Fail, NodeType, Path, Port, Tree};

pub(super) fn nodes() -> Vec<NodeType> {
    vec![
        merge(),
        entwine(),
        reshape("graft", "Graft", "Every item in a branch of its own: {0} becomes {0;0}, {0;1} and so on.", |t| {
            Ok(t.graft())
        }),
        reshape("flatten", "Flatten", "All items in one branch {0}, in the order of their paths.", flat),
        reshape("simplify", "Simplify", "Paths without the steps that all of them begin with.", |t| Ok(t.simplify())),
        reshape("reverse", "Reverse", "The items of every branch in reverse order.", |t| Ok(t.reverse())),
        partition(),
    ]
}

fn node(id: &'static str, name: &'static str) -> NodeType {
    NodeType::new(id, 1).name(name).category("Trees")
}

fn reshape(id: &'static str, name: &'static str, doc: &'static str, run: fn(&Tree) -> Result<Tree, Fail>) -> NodeType {
    node(id, name)
        .doc(doc)
        .keywords(&["tree", "branch", "path"])
        .input(Port::any("tree", Access::Tree).doc("A tree of any items."))
        .output(Port::any("tree", Access::Tree).doc("The reshaped tree."))
        .run(move |c| {
            let tree = run(c.tree("tree"))?;
            c.set_tree("tree", tree);
            Ok(())
        })
}

/// All items in one branch.
fn flat(tree: &Tree) -> Result<Tree, Fail> {
    let types: BTreeSet<&str> = tree.branches().iter().stoppable().map(|(_, c)| c.type_name()).collect();
    if let (Some(first), Some(second)) = (types.first(), types.iter().nth(1)) {
        let message = format!("{first} and {second} cannot be in one list");
        return Err(Fail::new("mixed-types", message));
    }
    Ok(tree.flatten())
}

fn merge() -> NodeType {
    node("merge", "Merge")
        .doc("Puts several trees into one: branches of the same path follow one another in the order of the wires.")
        .keywords(&["join", "combine", "collect"])
        .input(Port::any("trees", Access::Tree).doc("As many wires as there are trees."))
        .output(Port::any("tree", Access::Tree).doc("All branches of all of them."))
        .run(|c| {
            // The engine has merged the wires of this one port already.
            let tree = c.tree("trees").clone();
            c.set_tree("tree", tree);
            Ok(())
        })
}

/// Inputs of `entwine`.
const INPUTS: [&str; 8] = ["a", "b", "c", "d", "e", "f", "g", "h"];

fn entwine() -> NodeType {
    let mut node = node("entwine", "Entwine")
        .doc(
            "Keeps what comes in at different inputs in branches of their own: a in {0;0}, b in {0;1} and so on. An input \
             without a wire leaves its number free.",
        )
        .keywords(&["weave", "combine", "branches"]);
    for input in INPUTS {
        node = node.input(Port::any(input, Access::Tree).optional().doc("A tree of any items."));
    }
    node.input(
        Port::item::<bool>("flatten").default(true).doc(
            "Whether each input becomes one branch; if not, its paths go on behind its number: {1} of b is {0;1;1}.",
        ),
    )
    .output(Port::any("tree", Access::Tree).doc("The branches of all inputs."))
    .run(|c| {
        let flatten = c.boolean("flatten")?;
        let mut branches = Pending::new(Vec::new());
        for (i, input) in INPUTS.into_iter().enumerate() {
            entwined(c, input, Path::root().child(i), flatten, &mut branches)?;
        }
        c.set_tree("tree", Tree::from_branches(branches.take()));
        Ok(())
    })
}

fn entwined(c: &Call, input: &str, base: Path, flatten: bool, out: &mut Vec<(Path, Column)>) -> Result<(), Fail> {
    let tree = c.tree(input);
    if flatten {
        let flat = flat(tree).map_err(|fail| fail.port(input.to_owned()))?;
        out.extend(flat.branches().iter().map(|(_, column)| (base.clone(), column.clone())));
    } else {
        let below = |path: &Path| base.below(path.steps());
        out.extend(tree.branches().iter().stoppable().map(|(path, column)| (below(path), column.clone())));
    }
    Ok(())
}

fn partition() -> NodeType {
    node("partition", "Partition list")
        .doc(
            "Cuts every branch into branches of the given sizes, which repeat; the last one is what remains. {0} becomes \
             {0;0}, {0;1} and so on.",
        )
        .keywords(&["chunk", "split", "rows"])
        .input(Port::any("tree", Access::Tree).doc("A list, or a tree of lists."))
        .input(
            Port::tree::<i64>("sizes")
                .range(1.0, 1e9)
                .doc("Sizes; the branches of a tree of sizes belong to those of the tree, its last one to all that follow."),
        )
        .output(Port::any("tree", Access::Tree).doc("The pieces."))
        .run(|c| {
            let (tree, sizes) = (c.tree("tree"), c.tree("sizes"));
            let mut out = Pending::new(Vec::new());
            for (b, (path, column)) in tree.branches().iter().enumerate().stoppable() {
                let sizes = sizes.branches().get(b).or_else(|| sizes.branches().last()).and_then(|(_, s)| known(s));
                let pieces = sizes.and_then(|sizes| column.split(&sizes)).ok_or_else(|| {
                    Fail::new("no-size", format!("branch {path} has no size to cut it by, or not all are known"))
                        .port("sizes")
                })?;
                out.reserve(pieces.len());
                let pieces = Pending::new(pieces).each();
                out.extend(pieces.enumerate().stoppable().map(|(i, piece)| (path.child(i), piece)));
            }
            c.set_tree("tree", Tree::from_branches(out.take()));
            Ok(())
        })
}

/// Sizes without gaps.
fn known(sizes: &Column) -> Option<Vec<usize>> {
    (0..sizes.len()).stoppable().map(|i| sizes.get::<i64>(i).and_then(|s| usize::try_from(*s).ok())).collect()
}
