"""Boxes by queries, as the paper of TransFusion describes it: the highest peaks of a heat map ask one another and all cells once, and say
class and numbers (Bai et al., "TransFusion", CVPR 2022)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from scipy.optimize import linear_sum_assignment
from torch import nn
from torch.nn import functional

from convoy_baseline.examples import Targets
from convoy_baseline.grid import Array, Grid
from convoy_baseline.heads.losses import focal, heat_loss, number_loss
from convoy_baseline.layers import RARE, block, head
from convoy_baseline.targets import NUMBERS, boxes_at

ATTENTION_HEADS = 8
CLASS_COST, PLACE_COST, SIZE_COST = 1.0, 0.25, 0.5
"""Of a query that is matched with a box: of its class, of each cell between them, of logarithms of sizes."""
CLASS_WEIGHT = 1.0


@dataclass(frozen=True)
class Queries:
    """What is said of E egos by Q queries each."""

    heat: torch.Tensor
    """(E, K, h, w): logits."""
    cell: torch.Tensor
    """(E, Q): where each one asks from."""
    label: torch.Tensor
    """(E, Q): of which class its peak is."""
    peak: torch.Tensor
    """(E, Q): how high, 0 to 1."""
    classes: torch.Tensor
    """(E, Q, K): logits."""
    numbers: torch.Tensor
    """(E, Q, NUMBERS): dx and dy from the query's cell."""


class QueryHead(nn.Module):
    """Heat map, one layer of attention, numbers."""

    places: torch.Tensor

    def __init__(self, channels: int, classes: int, grid: Grid, queries: int, width: int) -> None:
        super().__init__()
        self.grid, self.classes = grid, classes
        self.queries = min(queries, classes * grid.cells**2)
        self.shared = block(channels, width)
        self.heat = head(width, classes, RARE)
        self.of_class = nn.Embedding(classes, width)
        self.of_place = nn.Sequential(nn.Linear(2, width), nn.ReLU(), nn.Linear(width, width))
        self.ask_others = nn.MultiheadAttention(width, ATTENTION_HEADS, batch_first=True)
        self.ask_cells = nn.MultiheadAttention(width, ATTENTION_HEADS, batch_first=True)
        self.network = nn.Sequential(nn.Linear(width, 2 * width), nn.ReLU(), nn.Linear(2 * width, width))
        self.norms = nn.ModuleList(nn.LayerNorm(width) for _ in range(3))
        self.say_class = said(width, classes, RARE)
        self.say_numbers = said(width, NUMBERS, 0.0)
        along = (torch.arange(grid.cells) + 0.5) / grid.cells * 2 - 1
        places = torch.stack(torch.meshgrid(along, along, indexing="ij"), dim=-1)
        self.register_buffer("places", places.flatten(0, 1), persistent=False)

    def forward(self, known: torch.Tensor) -> Queries:
        """Of (E, channels, h, w)."""
        known = self.shared(known)
        heat = self.heat(known).float()
        chance = heat.detach().sigmoid()
        highest = functional.max_pool2d(chance, 3, stride=1, padding=1)
        peak, index = torch.where(chance == highest, chance, 0.0).flatten(1).topk(self.queries)
        label, cell = torch.div(index, self.grid.cells**2, rounding_mode="floor"), index % self.grid.cells**2
        cells = known.flatten(2).transpose(1, 2)
        place = self.of_place(self.places)
        asking = torch.gather(cells, 1, cell[..., None].expand(-1, -1, cells.shape[2])) + self.of_class(label)
        here = place[cell]
        asked = asking + here
        asking = self.norms[0](asking + self.ask_others(asked, asked, asking, need_weights=False)[0])
        answer = self.ask_cells(asking + here, cells + place, cells, need_weights=False)[0]
        asking = self.norms[1](asking + answer)
        asking = self.norms[2](asking + self.network(asking))
        return Queries(heat, cell, label, peak, self.say_class(asking).float(), self.say_numbers(asking).float())

    def loss(self, said: Queries, targets: Targets) -> dict[str, torch.Tensor]:
        """Parts of it; each box has the query that costs least, all boxes of an ego together."""
        wanted = torch.zeros_like(said.classes)
        egos, queries, boxes = [], [], []
        for e in range(len(said.cell)):
            mine = (targets.box_ego == e).nonzero()[:, 0]
            if len(mine):
                query, box = self._matched(said, e, mine, targets)
                egos.append(torch.full_like(query, e))
                queries.append(query)
                boxes.append(mine[box])
        off = said.numbers.sum() * 0
        if egos:
            ego, query, box = torch.cat(egos), torch.cat(queries), torch.cat(boxes)
            wanted[ego, query, targets.box_label[box]] = 1.0
            numbers = self._from_query(said.cell[ego, query], targets.box_cell[box], targets.box_numbers[box])
            off = off + number_loss(said.numbers[ego, query], numbers)
        classes = focal(said.classes, wanted).sum() / wanted.sum().clamp(min=1)
        return {"heat": heat_loss(said.heat, targets.heat), "classes": CLASS_WEIGHT * classes, "boxes": off}

    def found(self, said: Queries, ego: int, most: int, least_score: float) -> tuple[Array, Array, Array]:
        """Boxes (N, 9), labels and scores of one ego, the surest first."""
        label = said.label[ego]
        score = said.classes[ego].sigmoid().gather(1, label[:, None])[:, 0] * said.peak[ego]
        order = torch.sort(score, descending=True, stable=True).indices[:most]
        order = order[score[order] >= least_score]
        numbers = said.numbers[ego, order].double().cpu().numpy()
        boxes = boxes_at(said.cell[ego, order].cpu().numpy(), numbers, self.grid)
        return boxes, label[order].cpu().numpy(), score[order].cpu().numpy()

    def _from_query(self, query: torch.Tensor, cell: torch.Tensor, numbers: torch.Tensor) -> torch.Tensor:
        """Numbers (N, NUMBERS) of boxes in cells as those of queries in other ones: x is against rows, y against columns."""
        side = self.grid.cells
        down = torch.div(query, side, rounding_mode="floor") - torch.div(cell, side, rounding_mode="floor")
        along = query % side - cell % side
        return torch.cat([numbers[:, :1] + down[:, None], numbers[:, 1:2] + along[:, None], numbers[:, 2:]], dim=1)

    def _matched(
        self, said: Queries, ego: int, mine: torch.Tensor, targets: Targets
    ) -> tuple[torch.Tensor, torch.Tensor]:
        with torch.no_grad():
            queries, count = len(said.cell[ego]), len(mine)
            cells, wanted = targets.box_cell[mine].repeat(queries), targets.box_numbers[mine].repeat(queries, 1)
            asked = self._from_query(said.cell[ego].repeat_interleave(count), cells, wanted).view(queries, count, -1)
            apart = (said.numbers[ego, :, None] - asked).abs()
            chance = said.classes[ego].sigmoid()[:, targets.box_label[mine]]
            cost = -CLASS_COST * chance + PLACE_COST * apart[..., :2].sum(-1) + SIZE_COST * apart[..., 3:6].mean(-1)
            query, box = linear_sum_assignment(np.nan_to_num(cost.cpu().numpy(), nan=1e6, posinf=1e6))
        device = mine.device
        return torch.as_tensor(query, device=device), torch.as_tensor(box, device=device)


def said(width: int, out: int, guess: float) -> nn.Sequential:
    """A small network of each query."""
    last = nn.Linear(width, out)
    nn.init.constant_(last.bias, guess)
    return nn.Sequential(nn.Linear(width, width), nn.ReLU(), last)
