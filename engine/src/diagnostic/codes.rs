//! The codes of the engine's own diagnostics: what each means and what helps. Every crate that makes diagnostics has such
//! a table; `docs/diagnostics.md` is written from them all, and a test holds them to the source.

/// One code of diagnostics, in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// The stable name, kebab-case.
    pub name: &'static str,
    /// What has happened, a sentence.
    pub means: &'static str,
    /// What to do about it, a sentence.
    pub help: &'static str,
}

impl Code {
    /// A line of a table.
    #[must_use]
    pub const fn new(name: &'static str, means: &'static str, help: &'static str) -> Self {
        Self { name, means, help }
    }
}

const fn code(name: &'static str, means: &'static str, help: &'static str) -> Code {
    Code::new(name, means, help)
}

/// Every code that the engine gives, sorted by name.
pub const CODES: &[Code] = &[
    code(
        "bad-address",
        "Something that should name a port is not of the form node.port.",
        "Write the node's id, a dot and the port's name.",
    ),
    code("bad-doc", "The description of an interface is not text.", "Give \"doc\" as text, or leave it out."),
    code(
        "bad-expectations",
        "The file of expectations is not one.",
        "The message says what is wrong; tenon test --record writes the file anew.",
    ),
    code(
        "bad-file",
        "The graph file is JSON, but a key in it is missing, unknown or of the wrong kind.",
        "The message names the key; docs/file-format.md and tenon schema say what may stand there.",
    ),
    code(
        "bad-id",
        "A node's id is empty or has a dot in it.",
        "Choose another id; dots stand between a node and its port.",
    ),
    code(
        "bad-layout",
        "The file of node positions cannot be read.",
        "Delete it: the graph does not need it, and editors write it anew.",
    ),
    code(
        "bad-literal",
        "A value in the file is not what its port takes.",
        "The message says what the port takes; tenon nodes TYPE lists the ports with units and ranges.",
    ),
    code("bad-position", "A node was to be moved to a place that is no number.", "Give finite coordinates."),
    code(
        "bad-range",
        "The range of an interface input is not finite, or its step is not above 0.",
        "Give finite limits and a step above 0, or none.",
    ),
    code(
        "bad-version",
        "The version of a node, an interface or a link is 0 or no whole number.",
        "Versions start at 1; the message says which it is.",
    ),
    code(
        "blocked",
        "The node did not run because something that it depends on failed or is missing.",
        "Look at the diagnostics of the node that it names; this one goes away with them.",
    ),
    code(
        "cache-damaged",
        "A result that was kept on disk is not what was written: a byte is another, or the end is missing.",
        "Nothing has to be done: the result was computed anew and replaces the damaged one. If it comes again, check the disk.",
    ),
    code(
        "cache-failed",
        "The folder of kept results cannot be read or written.",
        "The run is as good as without the folder, only slower. Look at its rights and at the space that is left.",
    ),
    code("cancelled", "The evaluation was asked to stop.", "Nothing of it stands; start it again."),
    code(
        "cluster-cycle",
        "A cluster contains itself, directly or through others; the message writes out how.",
        "Remove one of the instances that the message names.",
    ),
    code(
        "cluster-in-cluster",
        "A cluster was to be defined inside another cluster.",
        "Define it at the top of the file; clusters may use each other from there.",
    ),
    code(
        "clusters-too-deep",
        "Clusters within clusters nest deeper than the engine expands.",
        "Make the nesting flatter; the message gives the limit.",
    ),
    code(
        "cycle",
        "Nodes feed each other in a ring, which the message writes out.",
        "Remove one of the wires in the ring.",
    ),
    code(
        "duplicate-wire",
        "The same source is wired twice to one port.",
        "Remove one of the two, or put a merge between if the items are meant to come twice.",
    ),
    code(
        "empty-range",
        "The range that a cluster's input allows and that of the port behind it have nothing in common.",
        "Change the limits of the cluster's input so that some value suits both.",
    ),
    code(
        "engine-fault",
        "A value that should be in memory is not.",
        "This is a fault of the engine: please report it.",
    ),
    code(
        "file-too-large",
        "The graph file is larger than the engine reads.",
        "Keep data in files of their own and read them with nodes.",
    ),
    code(
        "formula-in-cluster",
        "A cluster cannot be taken apart, because a formula inside it has no equal in the graph around it.",
        "The message says why; give the input that the formula reads a value, or keep the cluster.",
    ),
    code(
        "gave-up",
        "A node stopped as if it had been cancelled, but nobody asked it to.",
        "This is a fault of the node: please report it.",
    ),
    code(
        "inside-cluster",
        "A value was to be set on a node inside a cluster, where every instance would have it.",
        "Set the cluster's input that the hint names, or change the cluster itself.",
    ),
    code(
        "json-syntax",
        "The file is not JSON; the message gives line and column.",
        "Mend it there. A file that ends too early was cut off while it was copied.",
    ),
    code(
        "linked-cluster",
        "A cluster that stands in another file was to be edited from here.",
        "Edit that file, or take the cluster into this one first.",
    ),
    code(
        "linked-digest",
        "A linked file is not the one that its cluster is pinned to.",
        "Look at what changed in it, then take it over with tenon fmt --update-links.",
    ),
    code(
        "linked-file",
        "A file that a cluster is linked from cannot be read, or is no graph.",
        "Put the file there, or correct the cluster's \"file\"; paths are relative to the file that links.",
    ),
    code(
        "linked-version",
        "A linked file has another interface version than its cluster is pinned to.",
        "Look at what changed in it, then take it over with tenon fmt --update-links.",
    ),
    code(
        "list-gap",
        "An item of a list is missing because it failed further up, and the node needs the whole list.",
        "Mend what made the gap, or take the failed item out of the list.",
    ),
    code(
        "migrated-node",
        "A node was written for an older version of its type and has been brought to today's.",
        "Save the graph, or run tenon fmt, to keep it so.",
    ),
    code(
        "migration-failed",
        "A node of an older version could not be brought to today's.",
        "The message says which key stands in the way; change it by hand, or make the node anew.",
    ),
    code("missing-input", "A port has neither a wire, nor a value, nor a default.", "Wire it or give it a value."),
    code(
        "mixed-types",
        "Values of different types arrive where all must be of one type.",
        "Separate them, or convert one kind into the other first.",
    ),
    code(
        "mixed-wires",
        "Nodes were to become a cluster, but a port of theirs takes wires from both sides of its border.",
        "Take all of its sources into the cluster, or none, or join them in a node of their own.",
    ),
    code(
        "more-faults",
        "So many items of one node have a fault that not all of them are told.",
        "Mend the first ones; the others are likely of the same kind.",
    ),
    code(
        "newer-node",
        "The node was written for a newer version of its type than this program has.",
        "Use a newer program.",
    ),
    code(
        "node-bug",
        "A node does not keep what its type promises.",
        "This is a fault of the node type: please report it to who made it.",
    ),
    code("not-a-choice", "A text is not one of the port's choices.", "The message lists them."),
    code(
        "not-convertible",
        "A wire's item cannot be turned into what the port takes.",
        "The message says why; tenon nodes --conversions lists what is turned by itself.",
    ),
    code("not-finite", "A number is infinite or not a number.", "Look for a division by zero further up."),
    code("not-utf8", "The file is not UTF-8 text.", "Save it as UTF-8."),
    code(
        "older-node",
        "The node was written for an older version of its type, and there is no step to today's.",
        "Make the node anew.",
    ),
    code("out-of-range", "A number is beyond the limits of its port or input.", "The message gives the limits."),
    code(
        "panic",
        "A node stopped in a state that its author did not foresee.",
        "The rest of the graph went on. This is a fault of the node: please report it with the graph.",
    ),
    code(
        "reserved-key",
        "Foreign data was to be put under a key that has a meaning in the file.",
        "Put it under another key, best in \"x\".",
    ),
    code("taken-id", "There is already a node of that id.", "Choose another id."),
    code(
        "taken-path",
        "A node's name begins like the paths of what is inside an instance.",
        "Rename one of the two; slashes stand between an instance and what is inside it.",
    ),
    code("too-deep", "The file nests deeper than the engine reads.", "Make it flatter."),
    code(
        "too-many-items",
        "A list would become longer than allowed, or all lists of one node together.",
        "The message gives the limit: make shorter lists, or match them by longest instead of cross.",
    ),
    code(
        "too-many-lanes",
        "Matching would call the node more often than the engine allows.",
        "Cross matching multiplies the lengths of all lists: match by longest, or shorten a list.",
    ),
    code(
        "too-many-nodes",
        "Instances of clusters come to more nodes, or longer paths, than the engine holds.",
        "Use fewer instances, or give one of them lists instead of many of them single values.",
    ),
    code(
        "unknown-cluster",
        "There is no cluster of that name, or it cannot be used.",
        "The hint names the nearest; a cluster that has faults of its own says them.",
    ),
    code("unknown-name", "There is no node, input, output or group of that name.", "The hint names the nearest."),
    code(
        "unknown-node",
        "There is no node type of that name; the node is kept as it is and blocks what depends on it.",
        "The hint names the nearest type; tenon nodes lists all. It may come from a plugin that is not here.",
    ),
    code(
        "unknown-port",
        "The node has no port of that name.",
        "The hint names the nearest; tenon nodes TYPE lists all.",
    ),
    code("unknown-source", "A wire comes from a node that is not in the graph.", "The hint names the nearest node."),
    code("unknown-wire", "A wire that is not there was to be removed.", "The hint names the nearest."),
    code(
        "unreadable-file",
        "A file that the graph reads could not be read.",
        "The message gives the system's reason. Paths are relative to the graph.",
    ),
    code("wired-input", "A value was to be set on a port that has a wire.", "Remove the wire, or set its source."),
    code(
        "wrong-type",
        "A wire carries a type that the port does not take, and there is no conversion.",
        "The message names both types; tenon nodes --conversions lists what is turned by itself.",
    ),
];
