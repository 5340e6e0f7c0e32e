"""Small IGES and STEP files, written by hand."""


def iges(entities, unit=(2, "MM")):
    """Fixed-format IGES of entities given as lists of parameters, the first the entity's type."""
    number, word = unit
    date = "15H20260101.000000"
    head = (
        f"1H,,1H;,4Htest,4Htest,4Htest,4Htest,32,38,6,308,15,4Htest,1.0,{number},{len(word)}H{word},1,0.1,{date},"
        f"1E-6,100.0,4Htest,4Htest,11,0,{date};"
    )
    general = [head[i : i + 72] for i in range(0, len(head), 72)]
    directory, parameters = [], []
    for n, entity in enumerate(entities):
        items = [f"{repr(x) if isinstance(x, float) else x}," for x in entity]
        items[-1] = items[-1][:-1] + ";"
        lines = [""]
        for item in items:
            if len(lines[-1]) + len(item) > 64:
                lines.append("")
            lines[-1] += item
        first, second = (
            [entity[0], len(parameters) + 1, *[0] * 6, "00000000"],
            [entity[0], 0, 0, len(lines), 0, *"   0"],
        )
        for k, row in enumerate((first, second)):
            directory.append("".join(f"{x:>8}" for x in row) + f"D{2 * n + 1 + k:7d}")
        parameters += [f"{line:<64}{2 * n + 1:8d}P{len(parameters) + k:7d}" for k, line in enumerate(lines, 1)]
    count = f"S{1:7d}G{len(general):7d}D{len(directory):7d}P{len(parameters):7d}"
    return "\n".join(
        [
            f"{'test':<72}S{1:7d}",
            *(f"{line:<72}G{k:7d}" for k, line in enumerate(general, 1)),
            *directory,
            *parameters,
            f"{count:<72}T{1:7d}",
            "",
        ]
    )


def entity_128(surface):
    """The parameters of a rational B-spline surface."""
    m, n = surface.weights.shape
    by_columns = surface.points.swapaxes(0, 1).reshape(-1).tolist()
    limits = [x for pair in surface.domain for x in pair]
    return [
        128, m - 1, n - 1, surface.degree_u, surface.degree_v, 0, 0, 0, 0, 0, *surface.knots_u.tolist(),
        *surface.knots_v.tolist(), *surface.weights.T.reshape(-1).tolist(), *by_columns, *limits,
    ]  # fmt: skip


def step(surface, prefix=".MILLI."):
    """STEP (AP203) of one rational surface in a geometric set, in metres with the SI prefix."""

    def real(x):
        return f"{x:.17E}"

    def table(rows, entry):
        return "(" + ",".join("(" + ",".join(map(entry, row)) + ")" for row in rows) + ")"

    def knots(values):
        distinct = sorted(set(values.tolist()))
        times = [int((values == x).sum()) for x in distinct]
        return f"({','.join(map(str, times))})", f"({','.join(map(real, distinct))})"

    m, n = surface.weights.shape
    names = [[100 + i * n + j for j in range(n)] for i in range(m)]
    points = [
        f"#{names[i][j]}=CARTESIAN_POINT('',({','.join(map(real, surface.points[i, j].tolist()))}));"
        for i in range(m) for j in range(n)
    ]  # fmt: skip
    (times_u, knots_u), (times_v, knots_v) = knots(surface.knots_u), knots(surface.knots_v)
    return "\n".join([
        "ISO-10303-21;", "HEADER;", "FILE_DESCRIPTION((''),'2;1');",
        "FILE_NAME('t','2026-01-01T00:00:00',(''),(''),'','','');", "FILE_SCHEMA(('CONFIG_CONTROL_DESIGN'));",
        "ENDSEC;", "DATA;", "#1=APPLICATION_CONTEXT('x');", "#3=PRODUCT_CONTEXT('',#1,'mechanical');",
        "#4=PRODUCT('p','p','',(#3));", "#5=PRODUCT_DEFINITION_FORMATION('','',#4);",
        "#6=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');", "#7=PRODUCT_DEFINITION('design','',#5,#6);",
        "#8=PRODUCT_DEFINITION_SHAPE('','',#7);", "#9=SHAPE_DEFINITION_REPRESENTATION(#8,#10);",
        "#10=GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#20),#11);",
        "#11=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#12,#13,#14))"
        "REPRESENTATION_CONTEXT('',''));",
        f"#12=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({prefix},.METRE.));",
        "#13=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));",
        "#14=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());", "#20=GEOMETRIC_SET('',(#21));",
        f"#21=(BOUNDED_SURFACE()B_SPLINE_SURFACE({surface.degree_u},{surface.degree_v},"
        f"{table(names, lambda k: f'#{k}')},.UNSPECIFIED.,.F.,.F.,.F.)"
        f"B_SPLINE_SURFACE_WITH_KNOTS({times_u},{times_v},{knots_u},{knots_v},.UNSPECIFIED.)"
        f"GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE({table(surface.weights.tolist(), real)})"
        "REPRESENTATION_ITEM('')SURFACE());",
        *points, "ENDSEC;", "END-ISO-10303-21;", "",
    ])  # fmt: skip
