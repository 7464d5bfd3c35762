//! The codes of the nodes' diagnostics: what each means and what helps.

use tenon_engine::Code;

const fn code(name: &'static str, means: &'static str, help: &'static str) -> Code {
    Code::new(name, means, help)
}

/// Every code that built-in nodes give besides the engine's own, sorted by name.
pub const CODES: &[Code] = &[
    code("attribute-length", "An attribute has not one value per row of its table.", "The message gives both numbers."),
    code(
        "axis-limit",
        "The machine would have to go beyond an axis's limit.",
        "The message says which axis and by how much; move or turn the part, or take a machine that reaches further.",
    ),
    code("bad-formula", "A formula cannot be read or computed.", "The message gives the column and what was expected."),
    code(
        "bad-machine",
        "A machine description cannot be read, or contradicts itself.",
        "The message names the key; docs/machines.md says what stands in it.",
    ),
    code("bad-obj", "An OBJ file cannot be read.", "The message gives the line."),
    code("bad-parameter", "Parameters of a node do not go together.", "The message says which and why."),
    code(
        "bad-template",
        "The template of a text cannot be read.",
        "The message gives the place; {0} stands for the first value.",
    ),
    code(
        "below-sacrificial-layer",
        "A tool would go deeper than the layer under the board.",
        "Make the hole or the cut shallower, or say that the layer is thicker in the machine's description.",
    ),
    code("board-no-area", "The margin leaves nothing of the board.", "Take a smaller margin or a larger board."),
    code(
        "border-cut-too-flat",
        "The cut at a border edge would lean so far that it has no end within the panel.",
        "Cut that side square, or with another plane or angle.",
    ),
    code("busy", "Another sweep works in the folder.", "Wait for it, or name another folder."),
    code(
        "cannot-write",
        "A value cannot be written in the format that was asked for.",
        "The message says what stands in the way.",
    ),
    code(
        "chamfer-too-flat",
        "A side of a part leans too far to be milled.",
        "The message gives the angle; cut the edge in another way, or tilt the panel less against its neighbour.",
    ),
    code(
        "crumpled",
        "Making the faces planar has folded the mesh more than it was.",
        "Allow a larger reach, or planarize a coarser mesh.",
    ),
    code(
        "curve-gap",
        "Copies of the control points do not meet, so the curve would have gaps.",
        "The message says where and how wide; move the points until they meet.",
    ),
    code(
        "curve-in-pieces",
        "A curve of several strips stands where one strip is needed.",
        "Use a scheme whose copies meet.",
    ),
    code(
        "curve-too-few-points",
        "There are not enough points for a curve.",
        "Give at least two points, or as many as the scheme asks for.",
    ),
    code("curve-too-long", "The curve would have more segments than a curve may.", "Take fewer iterations."),
    code(
        "curve-weight",
        "A weight, or the sum of weights at a point, is not greater than 0.",
        "Give positive weights.",
    ),
    code("curve-wrong", "The curve's input contradicts itself.", "The message says how."),
    code(
        "edge-too-short",
        "There is no room for a fastener on an edge.",
        "Take a smaller end distance, a shorter fastener, or allow one in the middle.",
    ),
    code(
        "empty-interval",
        "An interval begins where it ends, so nothing can be mapped from it.",
        "Give two different ends.",
    ),
    code("empty-list", "A list has no items where at least one is needed.", "Look at what was to fill it."),
    code("face-concave", "A face has a corner that points inwards.", "Split the face into convex ones."),
    code("face-crosses-itself", "The border of a face crosses itself.", "Put its corners in order."),
    code("face-no-area", "A face has no area.", "Take it out, or move its corners apart."),
    code(
        "face-not-planar",
        "A face is further from its plane than allowed.",
        "The message says how far; planarize the mesh first, or allow more.",
    ),
    code(
        "face-projected",
        "A face that was nearly planar has been laid into its plane.",
        "A warning; the message says how far corners have moved.",
    ),
    code("face-short-edge", "A face has an edge that is too short to be an edge.", "Weld the two corners."),
    code(
        "faces-collapsed",
        "Faces lost their area when corners were welded; they were left out.",
        "Weld within a smaller distance.",
    ),
    code("faces-turned", "Faces were turned over so that neighbours agree.", "A note; nothing to do."),
    code(
        "fastener-along-chamfer",
        "A fastener would run along the joint instead of through it.",
        "Give another direction.",
    ),
    code(
        "fastener-too-long",
        "A fastener is longer than the wood that it should hold.",
        "The message says how long it may be.",
    ),
    code(
        "feature-off-edges",
        "A fastener of a plugin gave a feature for an edge that was not selected.",
        "The message names panel and edge; the feature is left out. Tell the plugin's maker.",
    ),
    code(
        "feature-out-of-reach",
        "The machine cannot reach a hole, a slot or a pocket; it is left to hand work.",
        "The message says what is missing: a longer tool, a smaller tilt, the other face up.",
    ),
    code(
        "feature-outside-panel",
        "A fastener of a plugin gave a feature that lies off its panel.",
        "The message says how far; the feature is left out.",
    ),
    code(
        "fold-too-sharp",
        "Two panels meet at so small an angle that their chamfers have no end.",
        "The message gives the angle; make the surface smoother there, or the panels thinner.",
    ),
    code(
        "holder-in-board",
        "The tool's holder would touch the board.",
        "Take a longer tool; the message says by how much.",
    ),
    code(
        "hole-thin-wood",
        "Too little wood would remain beside a hole.",
        "The message says how much; move the hole, or take a thinner drill.",
    ),
    code("hole-too-deep", "A hole would come out on the other side.", "The message says how deep it may be."),
    code("holes-meet", "Two holes run into each other.", "Change the spacing, or alternate the heads."),
    code(
        "layout-of-other-parts",
        "The layout, the parts and the programs do not belong together.",
        "Wire them from the same chain.",
    ),
    code("lengths-differ", "Lists that go together have different lengths.", "The message gives both lengths."),
    code(
        "map-no-direction",
        "A panel has no edge, or the model no direction, to lay it along; it lies as it came.",
        "Choose another align.",
    ),
    code(
        "mark-does-not-fit",
        "A fixing hole or the address does not fit on a panel.",
        "A warning; make it smaller, or the panel larger.",
    ),
    code("mesh-broken", "The mesh contradicts itself.", "The message says where."),
    code(
        "mesh-mixed-orientation",
        "Neighbouring faces run in opposite directions.",
        "order_faces turns faces over until they agree.",
    ),
    code("mesh-not-manifold", "More than two faces meet at an edge.", "Split the mesh there."),
    code("missing-output", "A node of a plugin left an output without a value.", "The plugin's maker has to mend it."),
    code(
        "missing-plugin",
        "The graph requires a plugin that is not there, or one of another version.",
        "The hint says where to put it.",
    ),
    code("no-attribute", "A table has no attribute of that name.", "The hint lists those that it has."),
    code(
        "no-operation",
        "There is nothing that a tool could do on a part.",
        "Look whether its features or its outline got lost further up.",
    ),
    code(
        "no-order",
        "Items of this type cannot be put in order.",
        "Sort them as values, by keys that are numbers or texts.",
    ),
    code("no-size", "A branch has no size by which it could be cut.", "Give a size for every branch."),
    code(
        "no-such-entry",
        "A list of values has no entry of that name.",
        "The message lists the names; choose one of them or add the entry.",
    ),
    code(
        "no-such-index",
        "A vertex or face is named that the mesh does not have.",
        "The message gives how many there are.",
    ),
    code(
        "no-such-item",
        "A list is asked for an item that it does not have.",
        "The message gives its length; wrap counts on from the start.",
    ),
    code("no-such-tool", "A tool is named that the machine does not have.", "The message lists its tools."),
    code(
        "node-too-sharp",
        "Panels meet at a vertex so sharply that nothing would remain of their corner.",
        "Move the vertex, or take thinner panels.",
    ),
    code(
        "not-planar-yet",
        "Faces are still further from planar than was asked for.",
        "Take more iterations, a larger reach, or a larger threshold.",
    ),
    code(
        "part-larger-than-board",
        "A part does not fit on an empty board; it was left out.",
        "The message gives both sizes; take larger boards, or make smaller panels.",
    ),
    code(
        "plugin-died",
        "A plugin's own process ended in the midst of an evaluation, or did not answer in time.",
        "The message says how it ended; tell its maker. The next evaluation starts it anew.",
    ),
    code(
        "plugin-fault",
        "A plugin breaks its contract; the message says how.",
        "Tell its maker; tenon plugin check shows what is wrong.",
    ),
    code(
        "polygon-not-flat",
        "The corners of a polygon are further from its plane than allowed.",
        "The message says how far; move them, or allow more.",
    ),
    code(
        "proof-failed",
        "A program failed its proof and does not get its final name.",
        "The message gives the first reason with its line; docs/proof.md explains them.",
    ),
    code("range-too-wide", "The two ends of a range are further apart than a number can hold.", "Take nearer ends."),
    code(
        "safe-height",
        "The safe height is not above all that a tool must clear.",
        "Raise it in the machine's description; the message says to what.",
    ),
    code("same-file-name", "Two nodes make files of the same name.", "Give one of them another name."),
    code(
        "scheme-wrong",
        "The columns of a custom scheme do not make a scheme.",
        "The message says which column and why.",
    ),
    code("series-too-far", "A series leaves the numbers.", "Take fewer or smaller steps."),
    code(
        "stale-plan",
        "The graph or the program is another than when the plan was made.",
        "Make the plan again; what has not changed is not evaluated again.",
    ),
    code(
        "subdivision-point-unreachable",
        "A subdivision point cannot be where it was put.",
        "The message says how far off it stays.",
    ),
    code(
        "subdivision-points",
        "Subdivision points and their numbers do not go together.",
        "The message says which there are.",
    ),
    code(
        "surface-weight",
        "The weights of both curves give a point of the surface no weight.",
        "Their sum must exceed 1 everywhere.",
    ),
    code("surface-wrong", "The surface's input contradicts itself.", "The message says how."),
    code(
        "thickness-flips-face",
        "A panel is so thick that its back face turns inside out.",
        "The message gives the largest thickness that works.",
    ),
    code("too-large", "A result is larger than a number can hold.", "Take smaller values."),
    code("tool-too-long", "A tool does not fit between the spindle and the board.", "Take a shorter one."),
    code("tool-too-short", "A tool is too short for what it must cut.", "The message says how long it must be."),
    code(
        "turn-at-feed",
        "The machine would have to turn while it cuts, other than evenly.",
        "The message gives the line; this is a fault of the path: please report it.",
    ),
    code("weight-count", "There are not as many weights as points.", "Give one each, or none."),
    code("which-graph", "The folder holds no graph, or several.", "Name the file."),
    code("zero-vector", "A direction is the zero vector.", "Give it a length; any but 0 will do."),
];
